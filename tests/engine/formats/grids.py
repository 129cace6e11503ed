"""TextGrids as Praat and people write them."""

from __future__ import annotations

from pathlib import Path

LONG = """File type = "ooTextFile"
Object class = "TextGrid"

xmin = 0
xmax = 0.9
tiers? <exists>
size = 2
item []:
    item [1]:
        class = "IntervalTier"
        name = "words"
        xmin = 0
        xmax = 0.9
        intervals: size = 1
        intervals [1]:
            xmin = 0
            xmax = 0.9
            text = "say ""ma"" 3"
    item [2]:
        class = "IntervalTier"
        name = "phones"
        xmin = 0
        xmax = 0.9
        intervals: size = 2
        intervals [1]:
            xmin = 0
            xmax = 0.35
            text = "M"
        intervals [2]:
            xmin = 0.35
            xmax = 0.9
            text = "AA1"
"""
SHORT = (
    'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n0.9\n<exists>\n2\n"TextTier"\n"bell"\n0\n0.9\n1\n0.2\n"x"\n'
    '"IntervalTier"\n"phones"\n0\n0.9\n2\n0\n0.35\n"M"\n0.35\n0.9\n"AA1"\n'
)


def written(tmp_path: Path, content: str | bytes, ending: str, encoding: str = "utf-8") -> Path:
    path = tmp_path / f"cues{ending}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
    return path


def tier(*labels: str, name: str = "phones", first_s: float = 0.0) -> str:
    rows = "".join(f'{first_s + at}\n{first_s + at + 1}\n"{label}"\n' for at, label in enumerate(labels))
    return f'"IntervalTier"\n"{name}"\n{first_s}\n{first_s + len(labels)}\n{len(labels)}\n{rows}'


def grid(*tiers: str, kind: str = "ooTextFile", first_s: float = 0.0) -> str:
    head = f'File type = "{kind}"\n"TextGrid"\n\n{first_s}\n{first_s + 9}\n<exists>\n{len(tiers)}\n'
    return head + "".join(tiers)

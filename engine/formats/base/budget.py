"""How much one file may ask for, checked before memory is taken: a small file can declare a large one."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from engine.errors import FormatError

LONGEST_NAME = 60  # letters of a file's name in a sentence
UNCOUNTED = 10**15  # beyond this a number is damage, and its digits say nothing
ADVICE = "It is damaged, or made to fill the memory; if it is real, export it in parts."


@dataclass(frozen=True)
class Budget:
    """What reading one file may take. A reader asks `require` or `spend` with what the file declares, then allocates.

    Attributes
    ----------
    bytes : of memory that is alive at one time
    frames : of a performance, 9 hours at 60 frames per second
    nodes : things with a structure of their own: nodes of a scene, columns, tiers, spans, parts of a document
    values : numbers in all arrays together; 100 million take 800 MB as 64-bit numbers
    """

    bytes: int = 1 << 30
    frames: int = 2_000_000
    nodes: int = 100_000
    values: int = 100_000_000

    def require(self, file: str, *, bytes: int = 0, frames: int = 0, nodes: int = 0, values: int = 0) -> None:
        """Raise `FormatError` with one sentence where a file, by name, asks for more than there is or for less than none.

        The numbers are whole numbers of Python, which do not overflow: multiply before converting.
        """
        asked = {"bytes": bytes, "frames": frames, "nodes": nodes, "values": values}
        for what, number in asked.items():
            limit = getattr(self, what)
            if number < 0:
                raise FormatError(f"{_short(file)} declares a negative number of {_WORDS[what]}.")
            if number > limit:
                raise FormatError(
                    f"{_short(file)} asks for {_counted(number)} {_WORDS[what]}; Retake reads at most {limit:,}.",
                    ADVICE,
                )

    def spend(self, file: str, *, bytes: int = 0, frames: int = 0, nodes: int = 0, values: int = 0) -> Budget:
        """Return what is left after a part of a file; raises as `require` does. For parts that stay in memory together."""
        self.require(file, bytes=bytes, frames=frames, nodes=nodes, values=values)
        return replace(
            self,
            bytes=self.bytes - bytes,
            frames=self.frames - frames,
            nodes=self.nodes - nodes,
            values=self.values - values,
        )


_WORDS = {"bytes": "bytes of memory", "frames": "frames", "nodes": "parts", "values": "numbers"}
assert set(_WORDS) == {field.name for field in fields(Budget)}

BUDGET = Budget()


def _short(file: str) -> str:
    return file if len(file) <= LONGEST_NAME else f"{file[: LONGEST_NAME - 1]}…"


def _counted(number: int) -> str:
    return f"{number:,}" if number < UNCOUNTED else f"more than {UNCOUNTED:,}"

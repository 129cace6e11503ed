"""`retake review` and `retake check`: what was changed, and whether a take may go on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.progress import Shown, telling
from app.cli.reading import AUTOMATIC, Fps, ReadSides, sides_of
from app.printing import as_json as print_json
from app.printing import remark, say
from engine.errors import EditError, EngineError
from engine.quality import KINDS, TABLE
from engine.words import counted

if TYPE_CHECKING:
    from engine.formats.base.reading import Reading
    from engine.project import Note
    from engine.quality import Flag
    from engine.review.changes import Change, Comparison
    from engine.review.report import Pictures, Review

PICTURE_HEIGHT, NOTE_HEIGHT = 240, 360  # px
PICTURES = 60  # at most, of the changes that move the face furthest
INDEX = "index.html"
USUAL = ",".join(kind.name for kind in TABLE if kind.on)
FOUND, UNREAD = 1, 2  # exit codes: a take has what it must not have; one cannot be read


def review(
    before: Annotated[Path | None, typer.Argument(help="The take before its edits; or a project alone.")] = None,
    after: Annotated[Path | None, typer.Argument(help="The take after its edits.")] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="The report to write, an HTML file.")] = None,
    queue: Annotated[Path | None, typer.Option(help="A folder of pairs; a report of each goes to --out.")] = None,
    findings: Annotated[Path | None, typer.Option(help="Write flags and notes, as CSV or JSON.")] = None,
    for_editors: Annotated[
        Path | None, typer.Option("--markers", help="Write open flags and notes for editors, as EDL or CSV.")
    ] = None,
    offset: Annotated[float | None, typer.Option(help="Seconds by which the second take begins later.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the changes and flags as one JSON object.")] = False,
    pictures: Annotated[bool, typer.Option("--pictures/--no-pictures", help="Draw the face at each change.")] = True,
    progress: Shown = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Show what was changed between two takes, or in a project, and by how much.

    The exit code is 0, or 1 where the two do not look like one performance, or 2 where something cannot be read: of a
    queue, all else is reviewed.
    """
    from engine.formats.base.reading import Reading
    from engine.review import pairs

    reading = Reading(fps, sides_of(sides))
    if queue is not None:
        if findings is not None or for_editors is not None:
            raise EditError("A queue writes reports alone.", "Name two takes for --findings and --markers.")
        _review_queue(queue, out, reading, pictures=pictures, progress=progress)
        return
    if before is None:
        raise EditError("There is nothing to review.", "Name two takes, or a project.")
    wanted = _wanted(out, findings, for_editors)
    if not wanted and not as_json:
        raise EditError("Say where the report goes.", "Add -o REPORT.html, or --json to print it.")
    first, second = (None, before) if after is None else (before, after)
    found = pairs.review(first, second, offset_s=offset, reading=reading)
    for path, write in wanted.items():
        _write_text(path, write(found) if write is not None else _page(found, pictures=pictures, progress=progress))
    if as_json:
        print_json(_as_json(found))
    else:
        say(f"{_summary(found)}; wrote {', '.join(str(path) for path in wanted)}")
    if first is not None and not found.comparison.alignment.alike:
        remark(_not_alike(found))
        raise SystemExit(FOUND)


def _wanted(
    out: Path | None, findings: Path | None, markers: Path | None
) -> dict[Path, Callable[[Review], str] | None]:
    """Return what writes each file that is asked for, None for the report; raises `EditError` for a name that cannot be."""
    from engine.review.markers import FINDINGS, MARKERS, writer_for

    if out is not None and out.suffix.lower() not in (".html", ".htm"):
        raise EditError(f"{out.name} is not a name for a report.", "Use a name that ends in .html.")
    wanted: dict[Path, Callable[[Review], str] | None] = {} if out is None else {out: None}
    for path, kinds in ((findings, FINDINGS), (markers, MARKERS)):
        if path is not None:
            wanted[path] = writer_for(path, kinds)
    return wanted


def check(
    takes: Annotated[list[Path], typer.Argument(help="Takes or projects.", show_default=False)],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    fail_on: Annotated[str, typer.Option(help=f"Flags that must not be there: {', '.join(KINDS)}.")] = USUAL,
    least: Annotated[float, typer.Option(help="Only flags of at least this weight, 0..1.", min=0, max=1)] = 0.0,
    sound: Annotated[bool, typer.Option("--sound/--no-sound", help="Look at the sound beside a take too.")] = True,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Check takes for a pipeline: exit code 0 where all are fine, 1 where flags were found, 2 where one cannot be read."""
    from engine.formats.base.reading import Reading
    from engine.review import pairs

    reading = Reading(fps, sides_of(sides))
    kinds = [kind.strip() for kind in fail_on.split(",") if kind.strip()]
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        raise EditError(f"There is no flag called {unknown[0]!r}.", f"Flags are: {', '.join(KINDS)}.")
    also = kinds if fail_on != USUAL else ()
    rows, unread = [], 0
    for path in takes:
        try:
            found = pairs.flags(path, reading, sound=sound, also=also)
            flags = [flag for flag in found if flag.kind in kinds and flag.weight >= least]
            rows.append({"take": str(path), "ok": not flags, "flags": [asdict(flag) for flag in flags]})
        except EngineError as error:
            unread += 1
            rows.append({"take": str(path), "ok": False, "error": str(error), "flags": []})
    if as_json:
        print_json({"ok": all(row["ok"] for row in rows), "takes": rows})
    else:
        for row in rows:
            say(f"{row['take']}: {row.get('error') or _counted(row['flags'])}")
    if not all(row["ok"] for row in rows):
        raise SystemExit(UNREAD if unread else FOUND)


def _counted(flags: object) -> str:
    assert isinstance(flags, list)
    counts = {kind: sum(flag["kind"] == kind for flag in flags) for kind in KINDS}
    return ", ".join(f"{count} x {KINDS[kind]}" for kind, count in counts.items() if count) or "fine"


def _review_queue(folder: Path, out: Path | None, reading: Reading, *, pictures: bool, progress: bool | None) -> None:
    """Write a report of each pair, and a page that lists them; a pair that cannot be read does not stop the others."""
    from engine.review import pairs
    from engine.review.report import Entry, index

    if not folder.is_dir():
        raise EditError(f"{folder} is not a folder.", "Name a folder of pairs with --queue.")
    if out is None:
        raise EditError("Say which folder the reports go to.", "Add -o FOLDER.")
    found = pairs.pairs(folder)
    out.mkdir(parents=True, exist_ok=True)
    entries = []
    for number, (before, after) in enumerate(found, 1):
        remark(f"{number} of {len(found)}: {after.name}")
        target = out / f"{after.stem}.html"
        try:
            seen = pairs.review(before, after, reading=reading)
            _write_text(target, _page(seen, pictures=pictures, progress=progress))
            entries.append(Entry(after.name, target.name, _summary(seen)))
        except EngineError as error:
            entries.append(Entry(after.name, "", str(error)))
    _write_text(out / INDEX, index(entries))
    unread = sum(not entry.link for entry in entries)
    say(f"{counted(len(found), 'pair')}, {unread} of them unread; wrote {out / INDEX}")
    if unread:
        raise SystemExit(UNREAD)


def _write_text(out: Path, text: str) -> None:
    from engine.formats.base.atomic import write_bytes

    write_bytes(out, [text.encode()])


def _page(found: Review, *, pictures: bool, progress: bool | None) -> str:
    from engine.review.report import html

    return html(found, pictures=_drawing(found.comparison, telling("drawing", progress)) if pictures else None)


def _drawing(compared: Comparison, progress: Callable[[int, int], None]) -> Pictures:
    """Return what draws a change (before, after and their difference at its peak), and what was drawn with a note."""
    from app.preview import movie
    from app.preview.renderer import HEAT_FULL_MM
    from engine.review.report import Pictures

    shown = set(sorted(compared.changes, key=lambda change: -change.moved_mm)[:PICTURES])

    def draw(change: Change) -> bytes:
        if change not in shown:
            return b""
        return movie.comparison(
            compared.weights[change.peak], compared.after.weights[change.peak], height=PICTURE_HEIGHT
        )

    def draw_note(note: Note) -> bytes:
        frame = min(note.frame, len(compared.after) - 1)
        assert note.drawing is not None
        return movie.drawn_on(compared.after.weights[frame], note.drawing, height=NOTE_HEIGHT)

    return Pictures(draw, draw_note, HEAT_FULL_MM, progress)


def _not_alike(found: Review) -> str:
    compared = found.comparison
    return (
        f"{compared.before.name} and {compared.after.name} do not look like one performance "
        f"(correlation {compared.alignment.correlation:.2f}): what differs may be two recordings, or two people."
    )


def _summary(found: Review) -> str:
    compared = found.comparison
    changes, frames = counted(len(compared.changes), "change"), counted(int(compared.common.sum()), "frame")
    return (
        f"{changes} in {int(compared.differs.sum()):,} of {frames}, {counted(len(found.new_flags), 'new flag')}, "
        f"{len(found.gone_flags)} gone ({compared.alignment.sentence})"
    )


def _as_json(found: Review) -> dict[str, object]:
    compared = found.comparison

    def listed(flags: tuple[Flag, ...]) -> list[dict[str, object]]:
        return [asdict(flag) for flag in flags]

    return {
        "before": compared.before.name,
        "after": compared.after.name,
        "alignment": asdict(compared.alignment),
        "frames": {
            "common": int(compared.common.sum()),
            "differ": int(compared.differs.sum()),
            "identical": compared.identical,
        },
        "changes": [asdict(change) for change in compared.changes],
        "flags": listed(found.flags_after),
        "new_flags": listed(found.new_flags),
        "gone_flags": listed(found.gone_flags),
        "verdict": found.verdict.sentence if found.verdict is not None else "",
        "verdicts": [asdict(verdict) for verdict in found.verdicts],
        "notes": [asdict(note) for note in found.notes],
        "dismissed": [asdict(who) for _, who in found.dismissed],
    }


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(review)
    app.command()(check)

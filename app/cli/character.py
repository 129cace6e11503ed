"""`retake character import` and `retake drive`: other heads, with shapes or without."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.performance import MARKER_HELP, pairs, performance_of
from app.cli.reading import AUTOMATIC, Fps, ReadSides
from app.printing import as_json as print_json
from app.printing import say
from engine.errors import EditError
from engine.words import counted

if TYPE_CHECKING:
    from app.cli.performance import MarkedPerformance
    from engine.character import Character
    from engine.formats.characters.assemble import Import

Names = Annotated[
    list[str] | None, typer.Option("--name", help="Correct a match: the file's name=ARKit shape, or name=.")
]
Landmarks = Annotated[list[str] | None, typer.Option("--landmark", help="Place a landmark by hand: name=vertex.")]
Unit = Annotated[str | None, typer.Option(help="The file's unit, mm, cm, m or in; detected otherwise.")]
Up = Annotated[str | None, typer.Option(help="The file's upward axis: y, z, x, -y, -z or -x; detected otherwise.")]
Facing = Annotated[
    float | None,
    typer.Option(help="Degrees that the face is turned to its left, from z, or from -y with z up; detected otherwise."),
]


def import_(
    path: Annotated[Path, typer.Argument(help="A glTF, GLB or VRM file, a folder of OBJ files, or an ICT-FaceKit.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Where the character is written.")],
    unit: Unit = None,
    up: Up = None,
    facing: Facing = None,
    names: Names = None,
    landmarks: Landmarks = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Import a head of another program as a character, and list the meaning of each of its shapes."""
    from app.cli.tables import show
    from engine.character import save

    read = imported(path, unit=unit, up=up, facing=facing, names=names or [], landmarks=landmarks or [])
    save(read.character, out)
    if as_json:
        print_json(_summary(read))
        return
    rows = [
        {"in the file": row.source, "shape": row.shape if row.sure else "", "how": row.how, "likeness": row.likeness}
        for row in read.matches
    ]
    show(path.name, rows, as_json=False)
    for notice in read.notices:
        say(notice)
    say(f"Imported {counted(len(read.character.neutral), 'vertex', 'vertices')}. Written to {out}.")


def landmarks_(
    path: Annotated[Path, typer.Argument(help="A character that was imported, or any head that can be.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Where the character is written.")],
    landmarks: Landmarks = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Find the landmarks of a character again, from those that were placed by hand."""
    from app.cli.tables import show
    from engine.character import save
    from engine.formats.characters.landmarks import with_landmarks
    from engine.formats.characters.opening import character_of

    head = character_of(path)
    places = {name: head.vertex_of(_vertex(name, vertex)) for name, vertex in pairs(landmarks or []).items()}
    character, away_mm = with_landmarks(head, places)
    save(character, out)
    rows = [
        {"landmark": name, "vertex": character.number_of(vertex), "away_mm": away_mm[name], "by_hand": name in places}
        for name, vertex in character.landmarks.items()
    ]
    show(path.name, rows, as_json=as_json)


def imported(
    path: Path,
    *,
    unit: str | None = None,
    up: str | None = None,
    facing: float | None = None,
    names: Sequence[str] = (),
    landmarks: Sequence[str] = (),
) -> Import:
    """Read a head and correct what was detected; raises `EngineError`."""
    from engine.formats.characters.reading import Reading, import_head

    places = {name: _vertex(name, vertex) for name, vertex in pairs(list(landmarks)).items()}
    return import_head(path, Reading(unit or "", up or "", facing, pairs(list(names))), places)


def _summary(read: Import) -> dict[str, object]:
    return {
        "vertices": len(read.character.neutral),
        "unit": read.frame.unit,
        "up": read.frame.up,
        "facing_deg": read.frame.facing_deg,
        "shapes": [
            {"source": row.source, "shape": row.shape, "likeness": row.likeness, "how": row.how} for row in read.matches
        ],
        "landmarks": read.character.landmarks,
        "landmark_mm": read.landmark_mm,
        "notices": list(read.notices),
    }


def _vertex(name: str, text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise EditError(f"The landmark {name!r} needs the number of a vertex, not {text!r}.")
    return int(text)


def drive(
    markers: Annotated[Path, typer.Argument(help="Markers in a CSV, TRC or C3D file, or a take.")],
    mesh: Annotated[Path, typer.Option(help="The head to move: OBJ, glTF, or anything `character import` reads.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Where the moving mesh is written: .glb, .usd or .npz.")],
    points: Annotated[
        Path | None, typer.Option(help="Which vertex follows which marker: a CSV of marker,vertex; found otherwise.")
    ] = None,
    neutral: Annotated[int, typer.Option(help="For markers: a frame in which the face is at rest.")] = 0,
    unit: Unit = None,
    up: Up = None,
    facing: Facing = None,
    still: Annotated[bool, typer.Option("--still", help="For markers: leave the head's own motion out.")] = False,
    marker: Annotated[list[str] | None, typer.Option("--marker", help=MARKER_HELP)] = None,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Move a head that needs no shapes by points on its face; the head turns and goes as the markers do."""
    from engine import editing
    from engine.formats.characters.animation import require_ending, write

    require_ending(out)
    head = _head(mesh, unit=unit, up=up, facing=facing)
    performance = performance_of(
        markers, neutral=neutral, fps=fps, sides=sides, marker=marker, placed=points is not None
    )
    performance.show()
    followed = _followed(head, performance, points)
    moving = editing.drive(performance.performance, editing.DriveRequest(head, followed, still=still))
    write(moving, out)
    shared = sum(name in performance.performance.source.names for name in followed)
    moved = f"{counted(len(moving.rest), 'vertex', 'vertices')} by {counted(shared, 'point')}"
    say(f"Moved {moved} over {counted(len(moving.frames), 'frame')}. Written to {out}.")


def _head(path: Path, *, unit: str | None, up: str | None, facing: float | None) -> Character:
    """Read a head of ours or of another program as corrected; raises `EngineError`."""
    from engine.formats.characters.opening import character_of
    from engine.formats.characters.reading import Reading

    return character_of(path, Reading(unit or "", up or "", facing))


def _followed(head: Character, performance: MarkedPerformance, points: Path | None) -> dict[str, int]:
    """Return the vertex of each marker on a head, from a file or from the markers' landmarks."""
    from engine import editing
    from engine.formats.markers import layout as markers_layout

    if points is not None:
        return markers_layout.read(points, head=head)
    return performance.places(head) or editing.standard_places(head)


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    family = typer.Typer(help="Heads from other programs.", no_args_is_help=True)
    family.command("import")(import_)
    family.command("landmarks")(landmarks_)
    app.add_typer(family, name="character")
    app.command()(drive)

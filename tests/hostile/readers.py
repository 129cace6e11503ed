"""Every reader of the program with sound files to begin from; what a reader returns is used as the program uses it."""

from __future__ import annotations

import io
import itertools
import json
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.c3d import DEC, c3d
from tests.hostile import mutate
from tests.hostile.mutate import Mutation


@dataclass(frozen=True)
class Reader:
    """A reader under trial.

    Attributes
    ----------
    samples : makes sound files, (name, content), in a folder
    read : reads a file of the same ending and uses what it holds; may raise `EngineError` alone
    mutation : changes a content
    """

    samples: Callable[[Path], Iterator[tuple[str, bytes]]]
    read: Callable[[Path], object]
    mutation: Mutation


def _take_csv(folder: Path) -> Iterator[tuple[str, bytes]]:
    from engine.formats import livelink
    from engine.take import SHAPES, Take

    rng = np.random.default_rng(0)
    lost = np.zeros(12, bool)
    lost[4:6] = True
    take = Take(rng.random((12, len(SHAPES))).round(4), 60.0, lost, rng.random((12, 9)).round(3), start_s=86399.9)
    livelink.write(take, folder / "a.csv")
    yield "a.csv", (folder / "a.csv").read_bytes()
    yield "b.csv", livelink.header() + b"".join(b"00:00:%02d:00,0\n" % n for n in range(3)) + b"\n"


def _read_take(path: Path) -> None:
    from engine.formats import livelink

    take = livelink.read(path)
    livelink.write(take, path.with_name("written.csv"))


def _markers(*endings: str) -> Callable[[Path], Iterator[tuple[str, bytes]]]:
    def samples(folder: Path) -> Iterator[tuple[str, bytes]]:
        from engine.formats.markers import write
        from engine.formats.markers.capture import Markers

        positions = np.round(100 * np.random.default_rng(0).normal(size=(6, 4, 3)), 3)
        positions[2, 1] = np.nan
        for ending in endings:
            path = folder / f"a.{ending}"
            write(Markers(positions, ("nose", "lip upper", "x", "M5"), 59.94), path)
            yield path.name, path.read_bytes()

    return samples


def _read_markers(path: Path) -> None:
    from engine.formats import markers

    markers.read(path)


def _c3d(folder: Path) -> Iterator[tuple[str, bytes]]:
    positions = np.random.default_rng(0).normal(size=(6, 4, 3))
    yield "a.c3d", c3d(positions, ("nose", "lip", "x", "M5"))
    yield "b.c3d", c3d(positions, ("nose", "lip", "x", "M5"), processor=DEC, scale=0.01, long_frames=6)


GRID = (
    'File type = "ooTextFile"\nObject class = "TextGrid"\n\nxmin = 0\nxmax = 0.9\ntiers? <exists>\nsize = 1\nitem []:\n'
)
GRID += '    item [1]:\n        class = "IntervalTier"\n        name = "phones"\n        xmin = 0\n        xmax = 0.9\n'
GRID += "        intervals: size = 3\n"
ASSEMBLED = 25  # one scene of so many is made a head of
LABELS = ("M", "pʰ", "??")


def _grids(folder: Path) -> Iterator[tuple[str, bytes]]:
    rows = [(0.3 * at, 0.3 * at + 0.3, label) for at, label in enumerate(LABELS)]
    long = "".join(
        f'        intervals [{at}]:\n            xmin = {a:g}\n            xmax = {b:g}\n            text = "{label}"\n'
        for at, (a, b, label) in enumerate(rows, 1)
    )
    yield "a.TextGrid", (GRID + long).encode()
    short = '"ooTextFile"\n"TextGrid"\n0 0.9 ! seconds\n<exists>\n1 tier\n"IntervalTier" "MAU"\n0 0.9\n3\n'
    yield "b.TextGrid", (short + "".join(f'{a:g} {b:g} "{label}"\n' for a, b, label in rows)).encode("utf-16")


def _cues(folder: Path) -> Iterator[tuple[str, bytes]]:
    rows = [{"start": 0.0, "end": 0.1, "value": "X"}, {"start": 0.1, "end": 0.35, "value": "A"}]
    tags = "".join(f'<mouthCue start="{r["start"]}" end="{r["end"]}">{r["value"]}</mouthCue>' for r in rows)
    yield "a.tsv", b"0.00\tX\n0.10\tA\n0.35\tD\n"
    yield "a.xml", f'<?xml version="1.0"?><rhubarbResult><mouthCues>{tags}</mouthCues></rhubarbResult>'.encode()
    yield "a.json", json.dumps({"metadata": {"duration": 0.5}, "mouthCues": rows}).encode()


def _read_cues(path: Path) -> None:
    from engine.formats.cues import read_cues
    from engine.speech.lane import attached
    from engine.speech.visemes import classes_over

    heard: list[str] = []
    cues = read_cues(path, heard.append)
    assert all(len(sentence) < 400 for sentence in heard)
    classes_over(cues, frames=60, fps=60.0)
    if cues:
        assert len(attached(cues, path.name).classes)


def _projects(folder: Path) -> Iterator[tuple[str, bytes]]:
    from engine.formats import livelink
    from engine.project import Contents
    from engine.speech.lane import attached
    from engine.speech.visemes import Cue
    from engine.take import SHAPES, Take
    from tests.engine.project.projects import sample, stored

    made = sample(Take(np.random.default_rng(3).random((40, len(SHAPES))), 30.0, name="random"))
    from dataclasses import replace

    from engine.project import Verdict, change_between, mark_edit, viseme_edit

    lane = attached([Cue(0, 0.5, "M"), Cue(0.5, 0.9, "AA1")], "a")
    steps = (
        mark_edit("mark", made.marks, replace(made.marks, verdicts=(Verdict("x"),))),
        viseme_edit("v", change_between(None, lane)),
    )
    yield "a.retake", stored(replace(made, edits=(*made.edits, *steps)), folder)
    (folder / "a.csv").write_bytes(next(_take_csv(folder))[1])
    yield "b.retake", stored(Contents(livelink.read(folder / "a.csv")), folder)


def _read_project(path: Path) -> None:
    from engine.project import Project, peek, replay

    with_summary = peek(path)
    assert with_summary.changed.astimezone() and with_summary.frames / with_summary.fps < 1e9
    opened = Project.open(path)
    try:
        replay(opened.contents)
    finally:
        opened.close()


def _models(folder: Path) -> Iterator[tuple[str, bytes]]:
    from engine.clean.network import CleanConfig, CleanNetwork, config_of
    from engine.models.checkpoint import save_model

    network = CleanNetwork(CleanConfig(hidden=8))
    save_model(folder / "a.safetensors", network.state_dict(), kind="clean", config=config_of(network))
    yield "a.safetensors", (folder / "a.safetensors").read_bytes()


def _read_model(path: Path) -> None:
    from engine.clean.infer import load_network

    load_network(path)


def _sounds(folder: Path) -> Iterator[tuple[str, bytes]]:
    import soundfile

    samples = 0.5 * np.sin(np.arange(2000) / 7).astype(np.float32)
    for ending in ("wav", "flac", "ogg"):
        soundfile.write(folder / f"a.{ending}", np.stack([samples, -samples], axis=1), 16_000)
        yield f"a.{ending}", (folder / f"a.{ending}").read_bytes()


def _read_sound(path: Path) -> None:
    from engine.formats import audio

    audio.read(path).peaks(0.0, 1.0, 100)


def _films(folder: Path) -> Iterator[tuple[str, bytes]]:
    from tests.films import film, flash_and_click

    for ending in ("mp4", "mkv", "mov"):
        yield (
            f"a.{ending}",
            flash_and_click(folder / f"a.{ending}", at_s=0.2, sound_from_s=0.1, rate=16_000, length_s=0.4).read_bytes(),
        )
    yield "b.mp4", film(folder / "b.mp4", [0, 33, 80, 400], size=(32, 32)).read_bytes()


def _read_film(path: Path) -> None:
    from app.playback.video import Video
    from engine.errors import EngineError
    from engine.formats import audio

    refused: list[EngineError] = []
    try:
        reader = Video(path)
        try:
            for time_s in (0.0, 0.21, 0.05):
                reader.frame_at(time_s)
        finally:
            reader.close()
    except EngineError as error:
        refused.append(error)
    audio.read(path)
    if refused:
        raise refused[0]


def _heads(folder: Path) -> Iterator[tuple[str, bytes]]:
    from engine.character import BUNDLED

    with np.load(BUNDLED) as stored:
        made = io.BytesIO()
        np.savez(made, **dict(stored))
    yield "a.npz", made.getvalue()


def _read_head(path: Path) -> None:
    from engine.formats.characters.opening import character_of

    character_of(path)


def _scenes(folder: Path) -> Iterator[tuple[str, bytes]]:
    from tests.engine.formats.characters.test_gltf import document, glb

    yield "a.glb", glb(folder / "a.glb", *document()).read_bytes()


def _read_scene(path: Path) -> None:
    """Read a scene; now and then make a head of it, which takes ten times as long."""
    from engine.formats.characters import read
    from engine.formats.characters.opening import character_of

    if path.stat().st_size % ASSEMBLED == 0:
        character_of(path)
    else:
        read(path)


def _meshes(folder: Path) -> Iterator[tuple[str, bytes]]:
    yield "jawOpen.obj", b"v 0 0 0\nv 1 0 0\nv 0 1.5 0\nv 0 0 1\nf 1 2 3\nf 1/1 3/1 4/2\n"


def _read_mesh(path: Path) -> None:
    """Read a shape beside a neutral mesh that is sound."""
    from engine.formats.characters import obj

    folder = path.with_name("head")
    folder.mkdir(exist_ok=True)
    (folder / "neutral.obj").write_bytes(next(_meshes(folder))[1])
    (folder / "jawOpen.obj").write_bytes(path.read_bytes())
    obj.read(folder)
    obj.read_mesh(path)


def _scans(folder: Path) -> Iterator[tuple[str, bytes]]:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=1)
    yield "a.ply", ball.export(file_type="ply")
    yield "b.ply", ball.export(file_type="ply", encoding="ascii")
    yield "c.stl", ball.export(file_type="stl")
    yield "d.stl", ball.export(file_type="stl_ascii").encode()


def _read_scan(path: Path) -> None:
    from engine.formats.characters import scans

    scans.read(path)


def _label_files(folder: Path) -> Iterator[tuple[str, bytes]]:
    rows = [{"frame": 3, "weights": {"jawOpen": 0.4}}, {"frame": 12, "weights": {"mouthClose": 0, "tongueOut": 1}}]
    yield "a.json", json.dumps({"target": "heads/anna.npz", "labels": rows}).encode()
    yield "a.csv", b"frame,jawOpen,mouthClose\n3,.4,\n12,0,1\n"


def _read_labels(path: Path) -> None:
    from engine.formats import labels

    labels.read(path)


def _layouts(folder: Path) -> Iterator[tuple[str, bytes]]:
    yield "a.csv", b"marker,vertex\nnose,12\nlip upper,400\n"


def _read_layout(path: Path) -> None:
    from engine.character import bundled
    from engine.formats.markers import layout as markers_layout

    markers_layout.read(path, head=bundled())


def _packets(folder: Path) -> Iterator[tuple[str, bytes]]:
    from engine.live.livelink import Stamp, encode

    weights = np.random.default_rng(0).random(52).astype(np.float32)
    yield "a.udp", encode(Stamp(7, 0.25), weights, subject="Ana")
    yield "b.udp", encode(Stamp(8, 0.0, 1000, 1), None, subject="Ana")
    yield "c.udp", b"mouthSmile_R-40|eyeBlink_L-3|jawOpen-100|=head#1,2,3,0,0,0|rightEye#1,2,3|leftEye#1,2,3|"


class _Live:
    """One stream that goes on; its clock is a count."""

    def __init__(self) -> None:
        from engine.live.record import Recorder
        from engine.live.stream import Stream

        self.recorder, self.count = Recorder(), itertools.count()
        self.stream = Stream(on_arrival=self.recorder.add)

    def receive(self, data: bytes) -> None:
        from engine.errors import EditError
        from engine.live.record import Recorder

        number = next(self.count)
        self.stream.receive(data, number / 500, lambda: number / 500)
        if number % 2_000 == 1_999:
            try:
                self.recorder.take()
            except EditError as error:
                assert "Nothing was recorded" in error.sentence
            self.recorder = Recorder()
            self.stream.on_arrival = self.recorder.add


_live: list[_Live] = []


def _read_packet(path: Path) -> None:
    if not _live:
        _live.append(_Live())
    _live[0].receive(path.read_bytes())


def _take_zips(folder: Path) -> Iterator[tuple[str, bytes]]:
    rows = dict(_take_csv(folder))["a.csv"]
    card = {"version": 1, "slate": "a", "take": 1, "frames": 12, "videoTargetFrameRate": 60, "calibrated": True}
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in (("a/a_cal.csv", rows), ("a/a_raw.csv", rows), ("a/take.json", json.dumps(card).encode())):
            file.writestr(name, content)
    yield "a.zip", made.getvalue()


def _read_zip(path: Path) -> None:
    from engine.formats import read_take

    read_take(path)


READERS: dict[str, Reader] = {
    "live link csv": Reader(_take_csv, _read_take, mutate.text),
    "take zips": Reader(_take_zips, _read_zip, mutate.bundle),
    "marker csv and trc": Reader(_markers("csv", "trc"), _read_markers, mutate.text),
    "c3d": Reader(_c3d, _read_markers, mutate.binary),
    "textgrid": Reader(_grids, _read_cues, mutate.text),
    "mouth cues": Reader(_cues, _read_cues, mutate.text),
    "projects": Reader(_projects, _read_project, mutate.database),
    "models": Reader(_models, _read_model, mutate.tensors),
    "audio": Reader(_sounds, _read_sound, mutate.binary),
    "films": Reader(_films, _read_film, mutate.binary),
    "npz heads": Reader(_heads, _read_head, mutate.archive),
    "gltf": Reader(_scenes, _read_scene, mutate.scene),
    "obj": Reader(_meshes, _read_mesh, mutate.text),
    "ply and stl": Reader(_scans, _read_scan, mutate.binary),
    "labels": Reader(_label_files, _read_labels, mutate.text),
    "landmark csv": Reader(_layouts, _read_layout, mutate.text),
    "live packets": Reader(_packets, _read_packet, mutate.binary),
}

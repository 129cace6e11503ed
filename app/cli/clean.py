"""`retake clean`, `retake live` and `retake replay`: tracker noise removed, from a file or as it happens."""

from __future__ import annotations

import signal
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.reading import AUTOMATIC, SAME, Fps, ReadSides, WrittenSides, open_take, save_take
from app.printing import as_json as print_json
from app.printing import remark, say
from engine.errors import EngineError
from engine.formats import format_of, write_take
from engine.words import counted

if TYPE_CHECKING:
    from engine.live.listen import Listener
    from engine.live.record import Recorder
    from engine.live.spool import Spool
    from engine.take import Take

_TOLD_EVERY_S = 1.0


def clean(
    take: Annotated[Path, typer.Argument(help="The take to clean.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Where the cleaned take is written.")],
    strength: Annotated[float, typer.Option(help="0 leaves the take as it is, 1 cleans it fully.")] = 1.0,
    frames: Annotated[str | None, typer.Option(help="Only these frames, such as 40:60.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
    write_sides: WrittenSides = SAME,
) -> None:
    """Remove the tracker's noise from a take; frames outside the range stay bit-identical."""
    from engine import editing

    recorded = open_take(take, fps, sides)
    chosen = editing.parse_frames(frames, recorded) if frames else (0, len(recorded))
    cleaned = editing.cleaned(recorded, editing.CleanRequest(chosen, strength))
    save_take(cleaned.take, out, write_sides)
    start, stop = cleaned.touched
    removed = float(abs(cleaned.removed).max())
    if as_json:
        print_json({"out": str(out), "frames": [start, stop], "removed": removed, "lag_ms": cleaned.lag_ms})
    else:
        say(f"cleaned frames {start}:{stop} of {recorded.name}, at most {removed:.3f} of a weight removed")
        say(f"wrote {out}")


def live(
    *,
    port: Annotated[int, typer.Option(help="UDP port; Live Link Face sends to 11111.")] = 11111,
    bind: Annotated[
        str, typer.Option(help="Address to listen on; a phone is heard on 0.0.0.0, not on loopback.")
    ] = "127.0.0.1",
    subject: Annotated[str | None, typer.Option(help="Whose face; the first that arrives otherwise.")] = None,
    strength: Annotated[float, typer.Option(min=0.0, max=1.0, help="0 is raw, 1 is clean.")] = 1.0,
    record: Annotated[Path | None, typer.Option(help="Write what was sent to this take at the end.")] = None,
    seconds: Annotated[float | None, typer.Option(min=0.0, help="Stop after this long; Ctrl+C otherwise.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object a second.")] = False,
) -> None:
    """Listen to a phone, clean its face as it comes, and record it."""
    from engine.live.listen import Listener
    from engine.live.record import Recorder
    from engine.live.spool import Spool
    from engine.live.stream import Stream

    if record is not None:
        format_of(record)  # better refused now than after the performance
    recorder = Recorder()
    stream = Stream(subject=subject, strength=strength, on_arrival=recorder.add if record else None)
    with Listener(stream, bind=bind, port=port) as listener:
        spool = None if record is None else Spool(recorder, record)
        remark(f"listening on {listener.address[0]}:{listener.address[1]}")
        with _ended_by_signals():
            try:
                _tell(listener, seconds, spool, as_json=as_json)
            except (KeyboardInterrupt, BrokenPipeError):
                remark("stopped")
    if record is not None and spool is not None:
        _write_recording(recorder, spool, record)


def _write_recording(recorder: Recorder, spool: Spool, record: Path) -> None:
    try:
        taken = recorder.take(record.name)
    except EngineError:  # no face came
        spool.close(remove=True)
        raise
    try:
        write_take(taken, record)
    except EngineError as error:
        elsewhere = spool.path if _saved(spool) else _written_elsewhere(taken, record)
        raise EngineError(f"{error.sentence} The recording is in {elsewhere}.", error.advice) from error
    spool.close(remove=True)
    remark(f"wrote {record}: {counted(len(taken), 'frame')}, {int(taken.lost.sum())} of them lost")


def _saved(spool: Spool) -> bool:
    try:
        spool.save(all_rows=True)
    except EngineError:
        return False
    return True


def _written_elsewhere(taken: Take, record: Path) -> Path:
    """Write a recording to the folder for temporary files, since its own is full."""
    path = Path(tempfile.mkdtemp(prefix="retake-")) / record.with_suffix(".csv").name
    write_take(taken, path)
    return path


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let a closed terminal or a polite kill end a recording as Ctrl+C does."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    names = ("SIGTERM", "SIGHUP") if threading.current_thread() is threading.main_thread() else ()
    before = {
        getattr(signal, name): signal.signal(getattr(signal, name), stop) for name in names if hasattr(signal, name)
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _tell(listener: Listener, seconds: float | None, spool: Spool | None, *, as_json: bool) -> None:
    began = time.monotonic()
    while seconds is None or time.monotonic() - began < seconds:
        left = _TOLD_EVERY_S if seconds is None else min(_TOLD_EVERY_S, seconds - (time.monotonic() - began))
        time.sleep(max(0.0, left))
        if spool is not None:
            failed_before = spool.failed
            try:
                spool.save()
            except EngineError as error:
                if not failed_before:
                    remark(f"{error} The recording goes on in memory.")
        status = listener.status()
        listener.frames()
        latency = None if status.latency_p95_ms != status.latency_p95_ms else round(status.latency_p95_ms, 3)
        if as_json:
            counts = {"subjects": status.subjects, "frames": status.frames, "drops": status.drops}
            print_json({**counts, "latency_p95_ms": latency})
        else:
            drops = ", ".join(f"{count} {reason}" for reason, count in status.drops.items()) or "none dropped"
            late = "" if latency is None else f", p95 {latency} ms"
            say(f"{counted(status.frames, 'frame')}, {drops}{late}")


def replay(
    take: Annotated[Path, typer.Argument(help="The take to send.")],
    *,
    to: Annotated[str, typer.Option(help="HOST:PORT to send to.")] = "127.0.0.1:11111",
    loss: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share of packets that never arrive.")] = 0.0,
    reorder: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share that arrives behind the next.")] = 0.0,
    jitter_ms: Annotated[float, typer.Option(min=0.0, max=1000.0, help="Largest delay of a packet.")] = 0.0,
    repeat: Annotated[bool, typer.Option(help="Play it over and over, until Ctrl+C.")] = False,
    subject: Annotated[str, typer.Option(help="The name that is sent.")] = "Retake",
    fps: Fps = None,
    sides: ReadSides = AUTOMATIC,
) -> None:
    """Send a take at its own rate, as a phone would."""
    from engine.live.replay import Network
    from engine.live.replay import replay as send

    network = Network(loss, reorder, jitter_ms / 1e3)
    sent = send(open_take(take, fps, sides), _address(to), network, repeat=repeat, subject=subject)
    say(f"sent {counted(sent, 'packet')} to {to}")


def _address(text: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not host or not port.isascii() or not port.isdigit() or len(port) > 5 or not 0 < int(port) < 65536:
        raise EngineError(f"{text!r} is no address.", "Write host and port: 127.0.0.1:11111.")
    return host.strip("[]"), int(port)


def register(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(clean)
    app.command()(live)
    app.command()(replay)

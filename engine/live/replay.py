"""Playing a take as if a phone sent it, with the losses, disorder and jitter of a real network."""

from __future__ import annotations

import itertools
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from engine.errors import EngineError
from engine.live.livelink import Stamp, encode
from engine.take import Take


@dataclass(frozen=True)
class Network:
    """What the way does to packets.

    Attributes
    ----------
    loss : share of packets that never arrive
    reorder : share of packets that arrive behind the next one
    jitter_s : largest delay of a packet, seconds
    seed : the same way and seed treat the same take alike
    """

    loss: float = 0.0
    reorder: float = 0.0
    jitter_s: float = 0.0
    seed: int = 0


def packets(take: Take, *, subject: str = "Retake", first: int = 0) -> Iterator[bytes]:
    """Yield a take's frames as datagrams, numbered from `first`; lost frames say that no face is seen."""
    numerator, denominator = _fraction(take.fps)
    for index in range(len(take)):
        weights = None if take.lost[index] else take.weights[index].astype(np.float32)
        stamp = Stamp(first + index, 0.0, numerator, denominator)
        yield encode(stamp, weights, take.rotations[index].astype(np.float32), subject=subject)


def _fraction(fps: float) -> tuple[int, int]:
    return (round(fps), 1) if abs(fps - round(fps)) < 1e-9 else (round(fps * 1001), 1001)


def schedule(take: Take, network: Network) -> list[tuple[float, int]]:
    """Return when each frame that arrives is sent, seconds from the start, and its index, in the order of sending."""
    rng = np.random.default_rng(network.seed)
    frames = np.flatnonzero(rng.random(len(take)) >= network.loss)
    due = frames / take.fps + network.jitter_s * rng.random(len(frames))
    due += np.where(rng.random(len(frames)) < network.reorder, 1.5 / take.fps, 0.0)
    order = np.argsort(due, kind="stable")
    return [(float(due[index]), int(frames[index])) for index in order]


def replay(
    take: Take,
    address: tuple[str, int],
    network: Network | None = None,
    *,
    repeat: bool = False,
    subject: str = "Retake",
    stop: Callable[[], bool] = lambda: False,
) -> int:
    """Send a take at its own rate; returns how many packets were sent. Raises `EngineError` for an address that is none."""
    order = schedule(take, network or Network())
    sent = 0
    with socket.socket(_family(address), socket.SOCK_DGRAM) as out:
        for turn in itertools.count() if repeat else (0,):
            encoded = list(packets(take, subject=subject, first=turn * len(take)))
            sent += _send_once(out, address, encoded, order, stop)
            if stop():
                break
    return sent


def _send_once(
    out: socket.socket,
    address: tuple[str, int],
    encoded: list[bytes],
    order: list[tuple[float, int]],
    stop: Callable[[], bool],
) -> int:
    began = time.perf_counter()
    for sent, (due, index) in enumerate(order):
        if stop():
            return sent
        wait = began + due - time.perf_counter()
        if wait > 0:
            time.sleep(wait)
        try:
            out.sendto(encoded[index], address)
        except ConnectionRefusedError:
            continue  # nobody listens yet; a phone goes on sending too
        except OSError as error:
            raise EngineError(f"Nothing can be sent to {address[0]}:{address[1]}: {error.strerror}.") from error
    return len(order)


def _family(address: tuple[str, int]) -> socket.AddressFamily:
    try:
        found = socket.getaddrinfo(*address, type=socket.SOCK_DGRAM)
    except (OSError, OverflowError, UnicodeError) as error:
        raise EngineError(f"{address[0]}:{address[1]} is no address.", "Write it as 127.0.0.1:11111.") from error
    return found[0][0]

"""The computer's loudspeaker, through PortAudio."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Mapping
from typing import Any

from app.playback.clock import Pull, Sink

log = logging.getLogger(__name__)

LATENCY_S = 0.1  # what waits in the device: enough for the window to be busy without a gap in the sound
BELIEVABLE_S = 2.0


def names() -> list[str]:
    """Return what loudspeakers there are, as the system calls them."""
    try:
        import sounddevice

        return list(dict.fromkeys(str(each["name"]) for each in sounddevice.query_devices() if _plays(each)))
    except Exception as error:
        log.info("no sound: %s", error)
        return []


def open_device(rate: int, channels: int, *, wanted: str = "") -> Sink | None:
    """Return a loudspeaker by name, else the system's own; None where there is none, or no PortAudio."""
    try:
        import sounddevice  # itself an OSError where PortAudio is not installed

        device = _chosen(sounddevice, wanted)
        own = int(device["default_samplerate"])
    except Exception as error:  # whatever the reason, editing goes on in silence
        log.info("no sound: %s", error)
        return None
    for candidate in dict.fromkeys((rate, own)):
        try:
            return DeviceSink(candidate, channels, device)
        except (ValueError, sounddevice.PortAudioError) as error:  # some devices keep to their own rate
            log.info("no sound at %d Hz: %s", candidate, error)
    return None


def _plays(device: Mapping[str, Any]) -> bool:
    return int(device["max_output_channels"]) > 0


def _chosen(sounddevice: Any, wanted: str) -> Mapping[str, Any]:
    """Return what PortAudio says of a device that is there by name, else of the system's own."""
    every = sounddevice.query_devices() if wanted else ()
    own: Mapping[str, Any] = sounddevice.query_devices(kind="output")
    return next((each for each in every if each["name"] == wanted and _plays(each)), own)


class DeviceSink:
    """A stream of 32-bit samples; raises sounddevice.PortAudioError where the device refuses it.

    Parameters
    ----------
    rate, channels : of the stream, Hz and a number
    device : what PortAudio says of it
    """

    def __init__(self, rate: int, channels: int, device: Mapping[str, Any]) -> None:
        import sounddevice

        self.rate, self.name = rate, str(device["name"])
        self._rest = sounddevice.CallbackStop
        self._error = sounddevice.PortAudioError
        self._pull: Pull | None = None
        self._lock = threading.Lock()  # so that a start cannot fall between the last block and the rest
        self._stream = sounddevice.OutputStream(
            samplerate=rate,
            channels=channels,
            dtype="float32",
            latency=LATENCY_S,
            callback=self._fill,
            device=device["index"],
        )

    def start(self, pull: Pull) -> bool:
        """Begin to pull."""
        with self._lock:
            if self._pull is not None and self._stream.active:
                return True
            self._pull = pull
        try:
            self._stream.abort()
            self._stream.start()
        except self._error as error:
            log.warning("sound stopped: %s", error)
            return False
        return True

    def close(self) -> None:
        """Release the device."""
        self._stream.close()

    def _fill(self, out: Any, frames: int, times: Any, status: Any) -> None:
        """Fill a block, on PortAudio's thread."""
        waits_s = times.outputBufferDacTime - times.currentTime
        if not 0.0 < waits_s < BELIEVABLE_S:  # some drivers do not tell
            waits_s = self._stream.latency
        if status:
            log.debug("sound: %s", status)  # told by the driver after the fact; nothing can be done
        with self._lock:
            block = self._pull(frames, time.perf_counter() + waits_s) if self._pull else None
            if block is None:
                self._pull = None
        if block is None:
            out.fill(0)
            raise self._rest
        out[:] = block

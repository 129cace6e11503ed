"""Sentences said by eSpeak NG, with the times of their phones: its library runs in a process of its own.

Run as a file it takes jobs (voice, words per minute, text, file to write) as JSON and prints what was said when.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import json
import subprocess
import sys
import wave
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path

VOICES = ("en-us", "en-us+f3", "en-gb")
WORDS_PER_MINUTE = (130, 160, 190)
TEXTS = """
The boat left before our little brother woke up.
My mother put five warm muffins on the table.
We never saw the river from that window.
Please bring him a cup of coffee and some sugar.
The weather was better than anyone had thought.
She quickly opened the heavy wooden door.
Do you remember what happened last summer?
They bought a small house near the sea.
Both boys jumped over the broken fence.
Nobody knows where the old map is hidden.
A red balloon flew above the village church.
He promised to finish the work by Monday.
The children laughed at the funny green hat.
Put your shoes beside the back door.
Five men carried the piano up the stairs.
I have never been so happy in my life.
The judge asked for a short break.
Could you move the lamp a bit further away?
His voice was calm, but his hands were shaking.
Fresh bread and butter is all we need.
The train to Boston leaves at half past nine.
She wrote the whole story in one night.
Few people visit the museum in winter.
Open the box and tell me what you see.
The farmer sold his sheep and bought a truck.
My father taught me how to fix a bicycle.
There is no reason to shout at me.
We watched the moon rise behind the mountain.
The doctor will see you in a moment.
Somebody painted the kitchen wall purple.
The dog barked at every passing car.
You should think about it before you answer.
A cold wind blew through the empty street.
They measured the room from wall to wall.
Why would anyone leave such a beautiful place?
The captain pointed at a ship far away.
Our neighbour feeds the birds each morning.
Leave the window open while you sleep.
The price of milk went up again this week.
He found a silver coin under the bridge.
The teacher wrote the answer on the board.
I would rather walk than wait for the bus.
Everyone stood up when the music began.
The soup is too hot to eat right now.
She put the flowers in a tall glass vase.
Most of the money was spent on food.
Two young women sat near the fire.
The film was longer than I had expected.
Wash your hands before you touch the paper.
The thief ran off with both of the paintings.
""".strip().splitlines()


@dataclass(frozen=True)
class Job:
    """A sentence to be said."""

    voice: str
    words_per_minute: int
    text: str
    path: Path


def installed() -> bool:
    return ctypes.util.find_library("espeak-ng") is not None


def said(jobs: Sequence[Job]) -> list[list[tuple[float, str]]]:
    """Write what is said to each job's file; returns for each the phones, as IPA, with the seconds they begin at."""
    asked = json.dumps([[job.voice, job.words_per_minute, job.text, str(job.path)] for job in jobs])
    done = subprocess.run(
        [sys.executable, "-P", __file__], input=asked, capture_output=True, text=True, check=True, timeout=300
    )
    return [[(at / 1000, symbol) for at, symbol in json.loads(line)] for line in done.stdout.splitlines()]


def begun_late_s(truth: Sequence[tuple[float, str]], found: Sequence[tuple[float, str]]) -> list[float]:
    """Return by how much the phones of `found`, (seconds, class), begin later than those of the same class in `truth`."""
    matcher = SequenceMatcher(None, [name for _, name in truth], [name for _, name in found], autojunk=False)
    return [
        found[block.b + at][0] - truth[block.a + at][0]
        for block in matcher.get_matching_blocks()
        for at in range(block.size)
    ]


class _Id(ctypes.Union):
    _fields_ = (("number", ctypes.c_int), ("name", ctypes.c_char_p), ("string", ctypes.c_char * 8))


class _Event(ctypes.Structure):
    _fields_ = (
        ("type", ctypes.c_int),
        ("identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_ms", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user", ctypes.c_void_p),
        ("id", _Id),
    )


_PHONEME = 7


def _main() -> None:
    library = ctypes.CDLL(ctypes.util.find_library("espeak-ng"))
    rate = library.espeak_Initialize(2, 0, None, 1 | 2)  # synchronous; phonemes are told, in IPA
    sound, phones = bytearray(), []

    def receive(samples, count, events) -> int:
        if samples:
            sound.extend(ctypes.string_at(samples, 2 * count))
        at = 0
        while events[at].type:
            if events[at].type == _PHONEME:
                phones.append((events[at].audio_ms, events[at].id.string.decode("utf-8", "replace")))
            at += 1
        return 0

    callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event))
    held = callback(receive)
    library.espeak_SetSynthCallback(held)
    for voice, words_per_minute, text, path in json.load(sys.stdin):
        sound.clear(), phones.clear()
        library.espeak_SetVoiceByName(voice.encode())
        library.espeak_SetParameter(1, words_per_minute, 0)
        data = text.encode()
        library.espeak_Synth(data, len(data) + 1, 0, 1, 0, 1, None, None)
        library.espeak_Synchronize()
        with wave.open(path, "wb") as file:
            file.setparams((1, 2, rate, 0, "NONE", ""))
            file.writeframes(bytes(sound))
        print(json.dumps(phones))


if __name__ == "__main__":
    _main()

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from engine.errors import EditError, EngineError
from engine.formats import audio
from engine.speech import dictionary, espeak, hearing
from engine.speech.hearing import cuts, transcribed
from engine.speech.process import Cancelled
from engine.speech.sound import RATE
from engine.speech.transcript import Transcript, doubt
from engine.speech.visemes import NAMES, class_of
from tests.engine.speech.synthetic import TEXTS, VOICES, WORDS_PER_MINUTE, Job, begun_late_s, installed, said

BOAT = TEXTS[0]
hears = pytest.mark.skipif(
    not (dictionary.installed() and installed() and espeak.installed()), reason="PocketSphinx or eSpeak NG is missing"
)


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> audio.Audio:
    path = tmp_path_factory.mktemp("said") / "boat.wav"
    said([Job("en-us", 160, BOAT, path)])
    return audio.read(path)


def starts_of(transcript: Transcript) -> list[tuple[float, str]]:
    return [(cue.start_s, NAMES[class_of(cue.label)]) for cue in transcript.phones if cue.label != "SIL"]


def classes_of(truth: list[tuple[float, str]]) -> list[tuple[float, str]]:
    found = [(at, espeak.arpabet(symbol)) for at, symbol in truth]
    return [(at, NAMES[class_of(phones[0])]) for at, phones in found if phones]


def late_s(jobs: list[Job], *, noise_db: float | None = None) -> np.ndarray:
    """Return how late each phone begins over all sentences, every one of which must be aligned."""
    late, noise = [], np.random.default_rng(1)
    for job, truth in zip(jobs, said(jobs), strict=True):
        sound = audio.read(job.path)
        samples = np.asarray(sound.samples, np.float64)
        if noise_db is not None:
            samples = samples + 10 ** (-noise_db / 20) * samples.std() * noise.standard_normal(len(samples))
        late += begun_late_s(classes_of(truth), starts_of(transcribed(samples, sound.rate, text=job.text)))
    return np.array(late)


def sentences(folder: Path, count: int) -> list[Job]:
    """Return every sentence of `count` in a voice and at a rate, all of which take turns."""
    return [Job(VOICES[at % 3], WORDS_PER_MINUTE[at // 3 % 3], TEXTS[at], folder / f"{at}.wav") for at in range(count)]


def assert_within(late: np.ndarray, *, median_ms: float, most_ms: float, bias_ms: float) -> None:
    away = 1000 * np.abs(late)
    assert abs(1000 * np.median(late)) <= bias_ms
    assert np.median(away) <= median_ms and np.percentile(away, 90) <= most_ms


@hears
def test_phones_of_known_text_begin_where_they_are_said(tmp_path: Path) -> None:
    late = late_s(sentences(tmp_path, 9))
    assert len(late) > 200
    assert_within(late, median_ms=12, most_ms=40, bias_ms=3)


@hears
@pytest.mark.slow
@pytest.mark.parametrize(("noise_db", "median_ms", "most_ms"), [(None, 12, 40), (20, 12, 42), (10, 15, 55)])
def test_all_sentences_in_all_voices_and_rates(tmp_path: Path, noise_db: float | None, median_ms, most_ms) -> None:
    every = [
        Job(voice, rate, text, tmp_path / f"{voice}{rate}{at}.wav")
        for at, text in enumerate(TEXTS)
        for voice in VOICES
        for rate in WORDS_PER_MINUTE
    ]
    assert_within(
        late_s(every, noise_db=noise_db), median_ms=median_ms, most_ms=most_ms, bias_ms=3 if not noise_db else 5
    )


@hears
def test_a_transcript_reaches_over_the_recording_and_its_words_are_those_of_the_text(boat: audio.Audio) -> None:
    found = transcribed(boat.samples, boat.rate, text=BOAT)
    assert [each.word for each in found.said] == BOAT.rstrip(".").split()
    assert found.phones[0].start_s == 0.0 and found.phones[-1].stop_s == pytest.approx(boat.duration_s, abs=1e-4)
    assert all(before.stop_s == after.start_s for before, after in pairwise(found.phones))
    assert doubt(found) == "" and not found.heard
    lane = found.lane("boat.wav")
    assert lane.cues == found.phones and lane.source == "boat.wav"


@hears
def test_a_word_that_is_not_said_is_named(boat: audio.Audio) -> None:
    found = transcribed(boat.samples, boat.rate, text=BOAT.replace("brother", "elephant"))
    assert [found.said[at].word for at in found.doubtful] == ["elephant"] and "'elephant'" in doubt(found)


@hears
def test_a_text_that_is_not_said_is_one_sentence_and_the_next_one_is_aligned(boat: audio.Audio) -> None:
    with pytest.raises(EditError, match="not what is said"):
        transcribed(boat.samples, boat.rate, text="Seven green horses jumped over nine fences.")
    assert len(transcribed(boat.samples, boat.rate, text=BOAT).said) == 9


@hears
def test_words_that_no_dictionary_has_and_numbers_are_aligned(tmp_path: Path) -> None:
    text = "In 1984 the muffin cost $3.50 at Kubernetes."
    job = Job(
        "en-us",
        160,
        "In nineteen eighty four the muffin cost three dollars and fifty cents at Kubernetes.",
        tmp_path / "a.wav",
    )
    said([job])
    sound = audio.read(job.path)
    found = transcribed(sound.samples, sound.rate, text=text)
    assert len(found.said) == 14 and found.said[-1].word == "Kubernetes" and doubt(found) == ""


@hears
def test_stereo_and_other_rates_are_aligned_alike(boat: audio.Audio) -> None:
    from scipy.signal import resample_poly

    usual = [cue.start_s for cue in transcribed(boat.samples, boat.rate, text=BOAT).phones]
    stereo = np.stack([boat.samples, boat.samples], axis=1)
    assert [cue.start_s for cue in transcribed(stereo, boat.rate, text=BOAT).phones] == usual
    telephone = resample_poly(np.asarray(boat.samples, np.float64), 8000, boat.rate)
    found = transcribed(telephone, 8000, text=BOAT)
    away = [
        each.start_s - other.start_s
        for each, other in zip(found.said, transcribed(boat.samples, boat.rate, text=BOAT).said, strict=True)
    ]
    assert np.median(np.abs(away)) <= 0.03


@hears
def test_words_are_heard_and_then_aligned(boat: audio.Audio) -> None:
    found = transcribed(boat.samples, boat.rate)
    assert found.heard and found.said[-1].word == "up"
    assert found.phones[-1].stop_s == pytest.approx(boat.duration_s, abs=1e-4)


@hears
def test_nobody_waits_for_what_is_not_wanted_any_more(boat: audio.Audio) -> None:
    asked = []

    def follow(part: float) -> bool:
        asked.append(part)
        return len(asked) < 3

    begun = time.monotonic()
    with pytest.raises(Cancelled):
        transcribed(np.tile(boat.samples, 20), boat.rate, follow=follow)
    assert time.monotonic() - begun < 10  # of a minute or more of work, on any machine


@hears
@pytest.mark.parametrize(
    ("samples", "text", "sentence"),
    [
        (np.zeros(RATE), BOAT, "silent"),
        (np.zeros(1), BOAT, "too short"),
        (np.zeros(0), None, "too short"),
        (np.ones(RATE) * 0.1, "\N{GRINNING FACE} …", "no words"),
        (np.ones(RATE) * 0.1, "word " * 5_000, "more than anybody says"),
        (np.ones(RATE) * 0.1, "word " * 5_001, "at most 5,000"),
        (np.broadcast_to(0.1, 7_200 * RATE), None, "120 minutes"),
        (np.broadcast_to(0.1, 7_200 * RATE), BOAT, "120 minutes"),
    ],
)
def test_what_cannot_be_heard_is_one_sentence(samples: np.ndarray, text: str | None, sentence: str) -> None:
    with pytest.raises(EngineError, match=sentence):
        transcribed(samples, RATE, text=text)


@hears
def test_another_language_is_aligned_but_not_recognised(tmp_path: Path) -> None:
    text = "Der kleine Bruder wohnt in einem alten Haus am Meer"
    job = Job("de", 140, text, tmp_path / "de.wav")
    truth = classes_of(said([job])[0])
    sound = audio.read(job.path)
    with pytest.raises(EngineError, match="English alone can"):
        transcribed(sound.samples, sound.rate, language="de")
    found = transcribed(sound.samples, sound.rate, text=text, language="de")
    assert len(found.said) == 10
    assert np.median(np.abs(begun_late_s(truth, starts_of(found)))) < 0.04


def test_without_pocketsphinx_a_sentence_says_what_still_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hearing, "installed", lambda: False)
    with pytest.raises(EngineError, match=r"PocketSphinx.*retake\[speech\].*mouth cues"):
        transcribed(np.ones(RATE), RATE)


def test_a_recording_is_cut_where_it_is_quiet() -> None:
    sound = 0.1 * np.random.default_rng(0).standard_normal(40 * RATE)
    for quiet_s in (9, 18, 30):
        sound[int(quiet_s * RATE) : int((quiet_s + 0.2) * RATE)] = 0.0
    assert [round(edge / RATE, 1) for edge in cuts(sound)[1:-1]] == pytest.approx([9.1, 18.1, 30.1], abs=0.1)
    assert cuts(sound)[0] == 0 and cuts(sound)[-1] == len(sound)
    assert cuts(np.zeros(10)) == [0, 10]

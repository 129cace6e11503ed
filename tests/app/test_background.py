from __future__ import annotations

import threading

from pytestqt.qtbot import QtBot

from app.background import LatestWins
from engine.errors import EditError


def test_a_newer_request_replaces_the_waiting_one_of_its_channel(qtbot: QtBot) -> None:
    gate, seen, threads = threading.Event(), [], set()

    def job(request: str) -> str:
        threads.add(threading.get_ident())
        if request == "first":
            gate.wait(10)
        return request.upper()

    work = LatestWins(job, name="test")
    work.done.connect(lambda request, result: seen.append((request, result)))
    work.submit("first")
    qtbot.waitUntil(lambda: bool(threads))
    for request in ("second", "third"):
        work.submit(request)
    work.submit("other", "elsewhere")
    gate.set()
    qtbot.waitUntil(lambda: len(seen) == 3)
    assert seen == [("first", "FIRST"), ("third", "THIRD"), ("other", "OTHER")]
    assert len(threads) == 1 and threading.get_ident() not in threads
    work.stop()


def test_errors_come_as_sentences_and_the_thread_goes_on(qtbot: QtBot) -> None:
    def job(request: int) -> int:
        if request == 0:
            raise EditError("No.", "Try again.")
        if request == 1:
            raise ZeroDivisionError
        return request

    closed = []
    work = LatestWins(job, name="test", close=lambda: closed.append(True))
    told = []
    work.failed.connect(lambda request, sentence, advice: told.append((request, sentence, advice)))
    for request in (0, 1):
        with qtbot.waitSignal(work.failed):
            work.submit(request)
    with qtbot.waitSignal(work.done):
        work.submit(2)
    assert told[0] == (0, "No.", "Try again.")
    assert told[1][0] == 1 and told[1][1].startswith("Something went wrong")
    work.stop()
    assert closed == [True]

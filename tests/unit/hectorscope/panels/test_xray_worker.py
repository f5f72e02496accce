"""The thread that works for every browser that looks inside the matcher."""

import queue
import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hectorscope.panels._xray_shown import Shown
from hectorscope.panels._xray_wanted import Wanted
from hectorscope.panels._xray_words import ON_THE_WAY
from hectorscope.panels._xray_worker import MOST, Subject, Worker
from hectorscope.run.settings import Settings
from tests.xray import PAPER, other_scans, problem, scanned

PATIENCE_S = 30.0


class Listener:
    """A worker with what each browser was shown."""

    def __init__(self) -> None:
        self.shown: dict[int, queue.Queue[Shown]] = {}
        self.worker = Worker(lambda client, shown: self.of(client).put(shown))

    def of(self, client: int) -> "queue.Queue[Shown]":
        """What one browser was shown."""
        return self.shown.setdefault(client, queue.Queue())

    def next(self, client: int) -> Shown:
        """The next of it."""
        return self.of(client).get(timeout=PATIENCE_S)

    def arrived(self, client: int) -> Shown:
        """The next of it that is not on the way to a scan."""
        while (shown := self.next(client)).words == ON_THE_WAY:
            pass
        return shown


@pytest.fixture
def subject() -> Subject:
    rework, result = scanned()
    return Subject(rework, result, PAPER, Settings(PAPER))


def test_browsers_take_turns(subject: Subject):
    """A long work of one does not keep another waiting: that one is served before the basin is whole."""
    listener = Listener()
    listener.worker.look_at(subject)
    listener.worker.want(1, Wanted(lab="landscape", show="basin", span=2.0))
    assert "0 of 3721" in listener.next(1).words
    listener.worker.want(2, Wanted())
    first = listener.next(2)
    assert "(13)" in first.words
    while "3721 of 3721" not in (last := listener.next(1)).words:
        pass
    assert last.heat is not None
    for client in (1, 2):
        listener.worker.leave(client)


def test_a_dragged_start_is_followed_and_taken_back(subject: Subject):
    """What is shown begins at the new start; another scan begins at that of the run again."""
    listener, start = Listener(), problem().start + np.array([0.2, 0.1, 0.0])
    listener.worker.look_at(subject)
    listener.worker.want(1, Wanted(lab="landscape"))
    np.testing.assert_array_equal(handle(listener.next(1)), problem().start)
    listener.worker.start_at(1, start)
    np.testing.assert_array_equal(handle(listener.next(1)), start)
    listener.worker.look_at(replace(subject))
    np.testing.assert_array_equal(handle(listener.next(1)), problem().start)
    listener.worker.leave(1)


def test_a_kept_scan_stays_while_others_follow_the_run(subject: Subject):
    """With its start, until it is let go; another recording takes it away."""
    listener, start = Listener(), problem().start + np.array([0.2, 0.1, 0.0])
    first, second, third = (replace(subject, scan_s=seconds) for seconds in (1.0, 2.0, 3.0))
    listener.worker.look_at(first)
    keeps = Wanted(lab="landscape", keep=True)
    listener.worker.want(1, keeps)
    listener.worker.want(2, Wanted(lab="landscape"))
    assert (listener.next(1).scan_s, listener.next(2).scan_s) == (1.0, 1.0)
    listener.worker.start_at(1, start)
    np.testing.assert_array_equal(handle(listener.next(1)), start)
    listener.worker.look_at(second)
    assert listener.next(2).scan_s == 2.0
    listener.worker.want(1, replace(keeps, level=1))
    kept = listener.next(1)
    assert (kept.scan_s, kept.level) == (1.0, 1)
    np.testing.assert_array_equal(handle(kept), start)
    listener.worker.want(1, replace(keeps, keep=False))
    let_go = listener.next(1)
    assert let_go.scan_s == 2.0
    np.testing.assert_array_equal(handle(let_go), problem().start)
    listener.worker.want(1, keeps)
    assert listener.next(1).scan_s == 2.0
    listener.worker.look_at(third, anew=True)
    assert listener.next(1).scan_s == 3.0
    for client in (1, 2):
        listener.worker.leave(client)


def handle(shown: Shown) -> Any:
    assert shown.handle is not None
    return shown.handle


def test_the_thread_ends_with_the_last_browser(subject: Subject):
    """And begins again with the next one; without a scan at rest the words say what to do."""
    listener, before = Listener(), threading.enumerate()  # that of another test may not have ended yet
    listener.worker.want(1, Wanted())
    assert "Pause" in listener.next(1).words
    (thread,) = [each for each in threading.enumerate() if each.name == "xray" and each not in before]
    listener.worker.leave(1)
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
    listener.worker.look_at(subject)
    listener.worker.want(2, Wanted())
    assert "(7)" in listener.next(2).words
    listener.worker.leave(2)


def test_browsers_are_limited():
    """So many at a time; those beyond are shown nothing."""
    listener = Listener()
    for client in range(MOST + 5):
        listener.worker.want(client, Wanted())
    assert len(listener.worker.viewers) == MOST
    for client in range(MOST):
        listener.worker.leave(client)


def test_a_browser_goes_to_another_scan_by_itself(subject: Subject):
    """The one nearest to a time, and those beside it; it stays while the run goes on, until it is let go."""
    listener, others = Listener(), other_scans()
    listener.worker.look_at(replace(subject, scan_s=5.9))
    listener.worker.want(1, Wanted())
    assert listener.next(1).scan_s == 5.9
    listener.worker.visit(1, others, 3.02)
    there = listener.arrived(1)
    assert there.scan_s == pytest.approx(3.0, abs=0.06)
    assert "(7)" in there.words
    listener.worker.visit(1, others, None, by=-1)
    before = listener.arrived(1)
    assert before.scan_s == others.times[others.times.searchsorted(there.scan_s) - 1]
    listener.worker.look_at(replace(subject, scan_s=6.0))
    listener.worker.want(1, Wanted(keep=True, step=1))
    assert listener.arrived(1).scan_s == before.scan_s
    listener.worker.want(1, Wanted())
    assert listener.next(1).scan_s == 6.0
    listener.worker.leave(1)


def test_a_scan_that_cannot_be_reached_is_named(subject: Subject):
    """The reason stands in the card, and others are not disturbed."""
    listener, others = Listener(), replace(other_scans(), times=np.array([60.0]))
    listener.worker.look_at(subject)
    listener.worker.want(1, Wanted())
    listener.next(1)
    listener.worker.visit(1, others, 60.0)
    assert "the recording ends before that scan" in listener.arrived(1).words
    listener.worker.leave(1)

"""Questions and what can be taken back, over time."""

from hectorscope.session.commands import Restart
from hectorscope.session.questions import PATIENCE_S, Questions
from hectorscope.session.undo import MOST, UNDO_S, Kept, KeptValues, UndoStack


class Clock:
    """Stands still until a test moves it."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        """Seconds."""
        return self.now


def test_what_was_taken_away_is_kept_for_a_minute() -> None:
    """The newest comes back first; each is given up, and its owner told, when its own minute is over."""
    clock, dropped = Clock(), list[Kept]()
    stack = UndoStack(dropped.append, clock)
    first, second = KeptValues({"a": 1}), KeptValues({"a": 2})
    stack.push("first", first)
    clock.now += 40.0
    stack.push("second", second)
    assert stack.offer is not None
    assert (stack.offer.what, stack.offer.expires - clock.now, stack.left) == ("second", UNDO_S, UNDO_S - 40.0)
    clock.now += 20.0
    assert stack.lapse()
    assert dropped == [first]
    assert stack.pop() == ("second", second)
    assert stack.pop() is stack.offer is stack.left is None
    assert not stack.lapse()


def test_too_many_are_not_kept() -> None:
    """The least one goes, and never the one that is worth most."""
    dropped = list[Kept]()
    stack = UndoStack(dropped.append, Clock())
    for scans in (900, 5, 6, 7, 8, 9):
        stack.push("restart", KeptValues({}, scans))
    assert [kept.scans for kept in dropped] == [5, 6]
    left = [stack.pop() for _ in range(MOST)]
    assert [kept.scans for _, kept in filter(None, left)] == [9, 8, 7, 900]


def test_a_question_is_answered_once() -> None:
    """By its own number only; a newer one takes its place, and the command of the older is dropped."""
    questions = Questions(Clock())
    questions.ask(Restart(), "Map?", "Yes", "No")
    questions.ask(Restart(), "Really?", "Yes", "No")
    assert questions.open is not None
    assert (questions.open.number, questions.open.text) == (2, "Really?")
    assert questions.agreed(1) is None
    assert questions.agreed(2) == Restart()
    assert questions.agreed(2) is None


def test_a_question_that_nobody_answers_is_withdrawn() -> None:
    """Nothing happens then."""
    clock = Clock()
    questions = Questions(clock)
    assert not questions.lapse()
    questions.ask(Restart(), "Map?", "Yes", "No")
    clock.now += PATIENCE_S - 1.0
    assert not questions.lapse()
    clock.now += 1.0
    assert questions.lapse()
    assert questions.open is None
    assert questions.agreed(1) is None

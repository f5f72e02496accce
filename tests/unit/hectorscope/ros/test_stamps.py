"""Which stamps are believed."""

from collections.abc import Sequence

import pytest

from hectorscope.ros.stamps import AHEAD, BACKWARDS, Stamps

SECOND = 1_000_000_000
YEARS = 3e8


def faults(stamps: Sequence[float], received: Sequence[float] = (), *, repeats: bool = True) -> list[str]:
    """What is said of each of these seconds, in their order."""
    clock = Stamps(repeats=repeats)
    times = received or [0.0] * len(stamps)
    return [clock.fault(round(s * SECOND), round(r * SECOND)) for s, r in zip(stamps, times, strict=True)]


@pytest.mark.parametrize("leap", [11.0, 30.0, YEARS])
def test_a_lone_leap_ahead_costs_one_message(leap: float) -> None:
    """The one is refused and all behind it are used; so is another one later, and one that comes twice."""
    assert faults([0.0, 0.1, 0.2 + leap, 0.3, 0.4]) == ["", "", AHEAD, "", ""]
    assert faults([0.0, leap, 0.1, leap + 0.1, 0.2]) == ["", AHEAD, "", AHEAD, ""]
    assert faults([0.0, leap, leap, 0.1]) == ["", AHEAD, AHEAD, ""]


def test_a_leap_that_goes_on_is_believed_at_its_second_message() -> None:
    """A clock that was set ahead, or a pause, where nobody knows when the messages came."""
    assert faults([0.0, 0.1, 300.0, 300.1, 300.2]) == ["", "", AHEAD, "", ""]
    assert faults([0.0, 300.0, 900.0, 900.1]) == ["", AHEAD, AHEAD, ""]


def test_a_pause_that_was_waited_for_costs_nothing() -> None:
    """Times of receipt tell silence from a leap; a message a minute is all right, a lone leap after it is not."""
    assert faults([0.0, 300.0, 300.1], [7.0, 307.0, 307.1]) == ["", "", ""]
    assert faults([0.0, 60.0, 120.0, 180.0], [7.0, 67.0, 127.0, 187.0]) == [""] * 4
    assert faults([0.0, 60.0, 60.1 + YEARS, 60.2], [0.0, 60.0, 60.1, 60.2]) == ["", "", AHEAD, ""]


def test_a_clock_that_was_set_back_is_followed_after_two_messages() -> None:
    """The third in a row that goes on from the others is used, whether the time before was right or not."""
    assert faults([9.0, -3600.0, -3599.9, -3599.8, -3599.7]) == ["", BACKWARDS, BACKWARDS, "", ""]
    assert faults([YEARS, 0.0, 0.1, 0.2, 0.3]) == ["", BACKWARDS, BACKWARDS, "", ""]


def test_what_is_out_of_order_stays_refused() -> None:
    """A little late however often; far back but without order, repeated, or between others that go on."""
    assert faults([1.0, 0.5, 0.6, 0.7, 0.8, 1.1]) == ["", *[BACKWARDS] * 4, ""]
    assert faults([99.0, 50.0, 40.0, 30.0, 20.0, 99.1]) == ["", *[BACKWARDS] * 4, ""]
    assert faults([99.0, 50.0, 50.0, 50.0, 50.0, 99.1]) == ["", *[BACKWARDS] * 4, ""]
    second_unit = faults([99.0, 50.0, 99.1, 50.1, 99.2, 50.2, 99.3, 50.3])
    assert second_unit == ["", BACKWARDS] * 4


def test_a_stamp_may_come_again_where_that_is_allowed() -> None:
    """Two messages of one instant are two of a topic, but one of a transform."""
    assert faults([1.0, 1.0, 1.1]) == ["", "", ""]
    assert faults([1.0, 1.0, 1.1], repeats=False) == ["", BACKWARDS, ""]

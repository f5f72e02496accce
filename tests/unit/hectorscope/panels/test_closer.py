"""The card of a closer look, and what a browser may ask for."""

import math
from dataclasses import replace
from typing import Any

import pytest

from hectorscope.panels._closer import card_html, marks
from hectorscope.panels._request import FARTHEST, MOST_LEVELS, BadRequest
from hectorscope.panels.closer import REACH, command
from hectorscope.run.readings import BeamView, CellTarget, CellView, History, LevelReading, Span
from hectorscope.session.commands import AHEAD, Inspect, Pick

LEVELS = (LevelReading((4, -3), 0.05, 0.93, 0.08), LevelReading((2, -2), 0.1, None, 0.5))
CELL = CellView(0, 0.22, -0.13, LEVELS, History(Span(12, 12, 1.2, 1.2), Span(50, 99, 5.0, 9.9)))
BEAM = BeamView(17, 1081, 2.5, math.radians(-30.0), 0.004, (0.1, 0.2), 2.5, 0.01, 0.25, False, False, CELL)


def test_the_card_of_a_beam_says_what_was_measured_and_what_it_met() -> None:
    """Range, angle, time in the sweep, residual, and the cell that it hit on every level."""
    html = card_html(BEAM)
    for part in ("Beam 17", "of 1081", "2.500 m", "−30.00°", "4.00 ms", "0.250", "0.930", "unknown", "0.080"):
        assert part in html
    assert marks(BEAM) == {"beam": [0.1, 0.2, 0.22, -0.13], "cell": [0, 4 * 0.05, -3 * 0.05, 0.05]}


def test_the_card_says_to_what_a_range_was_smoothed() -> None:
    """Beside the measured one; of a range that was used as it is there is nothing to say."""
    html = card_html(replace(BEAM, used_m=2.441))
    assert "2.500 m" in html and "smoothed to" in html and "2.441 m" in html
    assert "smoothed" not in card_html(BEAM)


def test_the_card_says_of_a_beam_that_the_match_did_without_it() -> None:
    """It is on an object that may move; of all others there is nothing to say."""
    assert "left out" in card_html(replace(BEAM, left_out=True))
    assert "left out" not in card_html(BEAM)


@pytest.mark.parametrize(
    ("range_m", "word"),
    [(math.inf, "no return"), (-math.inf, "too close"), (math.nan, "no value"), (70.0, "limits")],
)
def test_the_card_says_why_a_beam_has_no_endpoint(range_m: float, word: str) -> None:
    """The values of REP-117 in words, a range out of the limits, and no beam timing where there is none."""
    html = card_html(BeamView(3, 10, range_m, 0.0, math.nan, (0.0, 0.0)))
    assert word in html
    assert "no endpoint" in html
    assert "no beam timing" in html


def test_the_card_of_a_cell_says_when_it_was_written() -> None:
    """One scan where that is known, the first and the last of several where it lies between."""
    html = card_html(CELL)
    assert "scan 12, 00:01.2" in html
    assert "scan 50 to 99, 00:05.0 to 00:09.9" in html
    assert "never" in card_html(CellView(0, 0.0, 0.0, LEVELS, History()))
    assert "in the saved map, or" in card_html(
        CellView(0, 0.0, 0.0, LEVELS, History(*[Span(1, 9, 0.0, 1.0)] * 2, True))
    )


def test_requests_are_brought_into_their_ranges() -> None:
    """Places, the reach and the number of a beam; anything else looks at nothing."""
    picked = command(5, {"at": [[99, 1e9, -2.0]], "reach": 1e9})
    assert picked == Inspect(5, Pick((CellTarget(MOST_LEVELS - 1, FARTHEST, -2.0),), REACH))
    assert command(5, {"beam": -7}) == Inspect(5, AHEAD)
    assert command(5, {}) == Inspect(5, None)


@pytest.mark.parametrize(
    "asked",
    [
        {"at": 3, "reach": 1.0},
        {"at": [[0, 1.0]], "reach": 1.0},
        {"at": [[0, math.nan, 1.0]], "reach": 1.0},
        {"at": [[0.5, 1.0, 1.0]], "reach": 1.0},
        {"at": [[0, 1.0, 1.0]]},
        {"at": [[0, 1.0, 1.0]] * 40, "reach": 1.0},
        {"at": [[0, "1", True]], "reach": 1.0},
        {"beam": 1.5},
        {"beam": True},
    ],
)
def test_what_no_script_of_ours_sends_is_refused(asked: dict[str, Any]) -> None:
    """Wrong types, numbers that are none, too many of them."""
    with pytest.raises(BadRequest):
        command(1, asked)

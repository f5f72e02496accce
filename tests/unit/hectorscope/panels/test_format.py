import math

import pytest

from hectorscope.panels._format import clock, figure, fixed, hint, label, number, text
from hectorscope.panels._hints import HINTS
from slam_core.config import SlamConfig, leaves

LEAVES = {leaf.name: leaf for leaf in leaves(SlamConfig())}


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (0.0, "00:00.0"),
        (59.96, "01:00.0"),
        (62.34, "01:02.3"),
        (3661.0, "1:01:01.0"),
        (-3.0, "00:00.0"),
        (math.nan, "00:00.0"),
    ],
)
def test_times_are_minutes_and_tenths(seconds: float, shown: str) -> None:
    """Tenths carry over into seconds and minutes; hours appear when there are some; nonsense is zero."""
    assert clock(seconds) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.2, "0.2"),
        (2048.0, "2048"),
        (1e-5, "10⁻⁵"),
        (2.5e-5, "2.5×10⁻⁵"),
        (-0.5, "−0.5"),
        (math.inf, "–"),
        (14344.0, "14340"),
        (-1e6, "−1000000"),
        (1.5e9, "1.5×10⁹"),
    ],
)
def test_numbers_are_short(value: float, shown: str) -> None:
    """Four digits at most, powers of ten for the tiny and the huge alone, a true minus sign."""
    assert number(value, 4) == shown


def test_fixed_decimals_never_show_a_negative_zero() -> None:
    """A value that rounds to zero has no sign; what is not finite is a dash."""
    assert fixed(-0.001, 2) == "0.00"
    assert fixed(-1.25, 1) == "−1.2"
    assert fixed(math.nan, 2) == "–"


def test_a_setting_is_named_for_people() -> None:
    """Underscores become spaces, the unit stands in brackets, the paper's letters are its own."""
    assert label(LEAVES["map.update_distance"]) == "Update distance (m)"
    assert label(LEAVES["fusion.omega"]) == "Weight of the match, ω"
    assert label(LEAVES["navigation.height_sigma"]) == "Height σ (m)"


@pytest.mark.parametrize("leaf", LEAVES.values(), ids=LEAVES)
def test_every_setting_says_what_it_does(leaf) -> None:
    """The hint holds the help text and the default, the range of a number, and the price of a restart."""
    said = hint(leaf)
    assert leaf.param.help in said
    assert "Default " in said
    assert ("Range " in said) == (leaf.param.low is not None)
    assert ("rebuilds the map" in said) == leaf.param.restart


def test_names_from_outside_cannot_become_html() -> None:
    """A topic or a file may be called anything."""
    assert text('<img src=x onerror="x">') == "&lt;img src=x onerror=&quot;x&quot;&gt;"


def test_a_figure_has_caption_value_and_hint() -> None:
    """The caption is small, a kind becomes a class; what there is to say now comes before the hint, escaped."""
    html = figure("beams", "7", "bad", more='<all> "gone"')
    assert html.startswith(
        '<span class="hs-figure hs-bad" title="&lt;all&gt; &quot;gone&quot;. Beams of this scan'
    )
    assert html.endswith("<small>beams</small>7</span>")
    assert "<small>m</small>" in figure("beams", "7", caption="m")


@pytest.mark.parametrize("hint", HINTS.values(), ids=HINTS)
def test_every_hint_says_what_it_is_and_when_to_worry(hint: str) -> None:
    """In two sentences or more, of which one is about worry."""
    first, *rest = hint.split(". ")
    assert len(first) > 10
    assert any("orry" in sentence for sentence in rest)

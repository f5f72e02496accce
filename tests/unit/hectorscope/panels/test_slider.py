import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.panels._slider import DECADE_STEP, Scale, round_step, scale_of
from slam_core.config import Leaf, SlamConfig, leaves

NUMBERS = [leaf for leaf in leaves(SlamConfig()) if leaf.type in (int, float)]


@pytest.mark.parametrize("leaf", NUMBERS, ids=lambda leaf: leaf.name)
def test_every_number_of_the_configuration_fits_its_slider(leaf: Leaf) -> None:
    """The default survives the way to the slider and back, to three digits, and is a value that may be set."""
    scale = scale_of(leaf)
    back = scale.from_slider(scale.to_slider(leaf.value))
    assert back == pytest.approx(leaf.value, rel=5e-3)
    assert leaf.check(back) == back


@pytest.mark.parametrize("leaf", NUMBERS, ids=lambda leaf: leaf.name)
def test_the_ends_of_every_slider_may_be_set(leaf: Leaf) -> None:
    """What a slider gives at its two ends, and beyond them, lies in the setting's range."""
    scale = scale_of(leaf)
    for position in (scale.low, scale.high, scale.low - 1, scale.high + 1):
        leaf.check(scale.from_slider(position))


@given(st.floats(math.log10(1e-3), math.log10(20.0)))
def test_a_logarithmic_slider_comes_back_to_where_it_was(position: float) -> None:
    """Position to value to position moves the slider by less than one step."""
    scale = Scale(math.log10(1e-3), math.log10(20.0), DECADE_STEP, log=True, integer=False)
    assert scale.to_slider(scale.from_slider(position)) == pytest.approx(position, abs=DECADE_STEP)


def test_a_logarithmic_slider_gives_equal_ratios() -> None:
    """The middle of a slider from 0.01 to 100 is 1, a quarter of it 0.1."""
    scale = Scale(-2.0, 2.0, DECADE_STEP, log=True, integer=False)
    assert scale.from_slider(0.0) == 1.0
    assert scale.from_slider(-1.0) == 0.1


@given(st.floats(1e-6, 1e6))
def test_steps_are_round(wanted: float) -> None:
    """A step is 1, 2 or 5 times a power of ten, no larger than asked and at least 2/5 of it."""
    step = round_step(wanted)
    assert f"{step:.0e}"[0] in "125"
    assert 0.39 * wanted <= step <= wanted * (1 + 1e-9)


def test_a_whole_number_stays_whole() -> None:
    """A slider of cells stands at an int."""
    leaf = next(leaf for leaf in NUMBERS if leaf.name == "map.size")
    assert isinstance(scale_of(leaf).to_slider(1024.4), int)

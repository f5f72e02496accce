"""Values of requests: checked, whatever a browser sends."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.panels._request import FARTHEST, MOST_LEVELS, BadRequest, place, words


@given(st.text(st.characters(codec=None), max_size=50))  # lone surrogates among them, as JSON may bring them
def test_words_can_be_written(text: str) -> None:
    """Into a file, whatever was sent; no longer than allowed, and without blanks around them."""
    found = words(text, 10)
    assert len(found.encode("utf-8").decode("utf-8")) <= 10
    assert found == found.encode().decode()


def test_words_are_text() -> None:
    """Nothing else is taken."""
    with pytest.raises(BadRequest):
        words(3, 10)


@pytest.mark.parametrize(("asked", "found"), [
    ([2, 1.5, -3], (2, 1.5, -3.0)),
    ([10**9, 1e300, -1e300], (MOST_LEVELS - 1, FARTHEST, -FARTHEST)),
    ([-1, 0, 0], (0, 0.0, 0.0)),
])  # fmt: skip
def test_a_place_is_brought_into_its_ranges(asked: list[Any], found: tuple[int, float, float]) -> None:
    """A level that may be there, and metres within the farthest."""
    assert place(asked) == found


@pytest.mark.parametrize(
    "asked", [None, [], [0, 1.0], [0, 1.0, 2.0, 3.0], {"x": 1}, "012", [0.5, 1, 2], [0, "1", 2], [0, math.nan, 0]]
)
def test_what_is_no_place_is_refused(asked: Any) -> None:
    """Other types, other lengths, numbers that are none."""
    with pytest.raises(BadRequest):
        place(asked)

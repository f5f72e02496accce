"""What a teacher's page may say of its view."""

import pytest

from hectorscope.panels._request import BadRequest
from hectorscope.panels.classroom import view

LAYERS = frozenset({"scan", "robot"})
GOOD = {"camera": ["free", 0, 1, 2, 3, 4, 5], "layout": "one", "gap": 0.5, "level": 0, "layers": {"scan": False}}


def test_a_view_passes_as_it_is():
    """Camera, layout and layers."""
    assert view(GOOD, LAYERS) == GOOD


def test_numbers_are_brought_into_their_ranges():
    """However far a page says it is."""
    far = view(GOOD | {"camera": ["top", 1e300, 0, 0, 0, 0, 0], "gap": 99, "level": -4}, LAYERS)
    assert far["camera"][1] == 1e6
    assert (far["gap"], far["level"]) == (2.0, 0)


@pytest.mark.parametrize(
    "wrong",
    [
        {"camera": ["fly", 0, 0, 0, 0, 0, 0]},
        {"camera": ["free", 0, 0]},
        {"camera": ["free", 0, 0, 0, 0, 0, float("nan")]},
        {"layout": "<script>"},
        {"layers": {"unknown": True}},
        {"layers": {"scan": 1}},
        {"level": 0.5},
        {"gap": "wide"},
    ],
)
def test_what_no_page_of_ours_says_is_dropped(wrong):
    """BadRequest; the class goes on with the view before."""
    with pytest.raises(BadRequest):
        view(GOOD | wrong, LAYERS)


@pytest.mark.parametrize("asked", [None, {}, [], {"camera": GOOD["camera"]}])
def test_a_view_is_whole(asked):
    """A part of one is none."""
    with pytest.raises(BadRequest):
        view(asked, LAYERS)

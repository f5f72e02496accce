"""What a page may ask of a robot that is driven by hand."""

import pytest

from hectorscope.panels._request import BadRequest
from hectorscope.panels.drive import request
from hectorscope.steering import PutBox, SetDoor, SetFault, Steer, TakeBox


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ({"steer": [2, -0.5]}, Steer(1.0, -0.5)),
        ({"fault": "sway", "value": 1e300}, SetFault("sway", 20.0)),
        ({"door": 1, "open": False}, SetDoor(1, False)),
        ({"box": 0, "at": [1, 1e9]}, PutBox(0, (1.0, 1000.0))),
        ({"box": 0, "at": "ahead"}, PutBox(0, None)),
        ({"box": 0, "at": None}, TakeBox(0)),
    ],
)
def test_what_the_page_asks_is_brought_into_its_range(asked, wanted):
    """Each kind of request becomes a value within its limits."""
    assert request(asked) == wanted


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"steer": [float("nan"), 0]},
        {"steer": [1]},
        {"steer": ["1", "0"]},
        {"fault": "gravity", "value": 1},
        {"fault": "sway", "value": True},
        {"door": 0.5, "open": True},
        {"door": 0, "open": 1},
        {"box": "0", "at": None},
        {"box": 0, "at": [1, 2, 3]},
        {"box": 0},
    ],
)
def test_what_no_script_of_ours_sends_is_dropped(asked):
    """BadRequest for anything else."""
    with pytest.raises(BadRequest):
        request(asked)

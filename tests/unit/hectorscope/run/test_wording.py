"""The codes of the core as sentences."""

from typing import get_args

import numpy as np
import pytest

from hectorscope.run.arrivals import Arrival
from hectorscope.run.wording import (
    DIAGNOSTICS,
    arrival_text,
    diagnostic_text,
    rejection_text,
    search_text,
    start_text,
    verdict_text,
)
from slam_core.diagnostics import Code, Diagnostic
from slam_core.results import ACCEPTED, Rejection, SearchFailure, StartFound, Verdict


def test_every_diagnostic_has_a_sentence():
    """Each code of the core has words with a remedy, which come after a colon or a semicolon."""
    assert set(DIAGNOSTICS) == set(get_args(Code))
    assert all(set(text) & set(":;") for text in DIAGNOSTICS.values())


def test_a_sentence_names_the_sensor_and_the_value():
    """The source and the value stand in the sentence."""
    assert diagnostic_text(Diagnostic("map_limit", value=1024.0)).startswith(
        "the map stopped growing at its limit of 1024 MB"
    )
    assert diagnostic_text(Diagnostic("aid_frozen", "height")).startswith("height repeats one value")
    assert arrival_text(Arrival("late", "heights")).startswith("heights come over 0.15 s after")


@pytest.mark.parametrize(
    ("rejection", "text"),
    [
        (Rejection("overlap", 0.1, 0.3), "only 10% of the scan lie where the map is known; 30% are needed"),
        (
            Rejection("inlier_ratio", 0.2, 0.9),
            "the scan fits the map badly: 20% of its points lie on walls, usually 90%",
        ),
        (Rejection("mahalanobis_distance", 400.0, 100.0), "the match is 400 sigmas away from the predicted pose"),
        (
            Rejection("hidden", 0.87, 0.6),
            "something near the laser hides walls of the map: 87% of the beams end before them",
        ),
        (
            Rejection("objects", 0.64, 0.4),
            "much of what the laser sees may move: 64% of the scan lie on objects that stand alone",
        ),
        (
            Rejection("endpoints", 3, 20),
            "next to nothing returns: 3 beams, and it takes 20 to tell a place",
        ),
        (
            Rejection("unobservable", 3.64, 1.0),
            "no beam fixes the way along one direction, and it is only known to ±3.6 m by now",
        ),
    ],
)
def test_a_rejection_has_its_figures(rejection: Rejection, text: str):
    """The value, and the limit that it missed."""
    assert rejection_text(rejection) == text
    assert (
        verdict_text(Verdict("recovered", rejection, recovery="relocalised"))
        == f"{text}; relocalised by a search of the whole map"
    )


def test_the_remedy_for_late_data_is_one_that_can_still_be_applied():
    """In a stream the network can be looked after; in a recording there is no link any more."""
    for fault in (Arrival("late", "heights"), Arrival("scans_stopped")):
        assert "network" in arrival_text(fault, live=True)
        assert "recording" in arrival_text(fault)
    late = Diagnostic("aid_too_late", "height")
    assert "network" in diagnostic_text(late, live=True)
    assert not any("link" in text or "network" in text for text in (diagnostic_text(late), arrival_text(fault)))


def test_a_good_match_has_no_words():
    """Nothing is said while all is well."""
    assert verdict_text(ACCEPTED) == search_text(None) == ""


def test_a_failed_search_has_its_reason():
    """Each code, with its figures."""
    assert search_text(SearchFailure("pending")) == "searching the whole map"
    assert "40% of it agree at best, 85% are needed" in search_text(SearchFailure("no_place", 0.4, 0.85))
    assert "nothing comes near" in search_text(SearchFailure("no_place", 0.0, 0.85))
    assert "in 2 places of the map alike" in search_text(SearchFailure("ambiguous", 2))
    assert "very many places" in search_text(SearchFailure("crowded"))
    assert "(3 possible)" in search_text(SearchFailure("unconfirmed", 3))


def test_a_start_has_its_pose():
    """The pose and the share of the scan; and whether it is another place than the one given."""
    pose = np.array([1.0, -2.0, 0.5])
    assert start_text(StartFound(pose, 0.97, False)) == (
        "the robot starts at x 1.00 m, y -2.00 m, yaw 0.50 rad of the map: 97% of the scan agree"
    )
    assert "does not start at the given pose" in start_text(StartFound(pose, 0.97, True))

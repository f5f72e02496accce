"""The words of --vary."""

import pytest

from hectorscope.sweep.vary import Axis, VaryError, check_axes, combinations, parse
from slam_core.errors import SlamError


def test_values_are_listed():
    """Numbers, switches and choices, each as its setting takes it, and each once."""
    assert parse("matcher.sigma=0.1, 0.2,0.4,0.2").values == (0.1, 0.2, 0.4)
    assert parse("map.levels=2,3").values == (2, 3)
    assert parse("scan.deskew=true,false").values == (True, False)
    assert parse("fusion.method=fixed,kalman").values == ("fixed", "kalman")


def test_a_range_has_steps():
    """Equal ones, or equal factors; those of a whole number are whole and not repeated."""
    assert parse("fusion.omega=0.01:0.5:log5").values == (0.01, 0.02659, 0.07071, 0.188, 0.5)
    assert parse("fusion.omega=0.1:0.5:5").values == (0.1, 0.2, 0.3, 0.4, 0.5)
    assert parse("map.levels=1:3:5").values == (1, 2, 3)


def test_sensor_options_are_varied_by_their_names():
    """A delay is a number, a unit a word."""
    assert parse("sensors.scan_delay=0:0.2:3").values == (0.0, 0.1, 0.2)
    assert parse("sensors.imu_accel_unit=g,mg").values == ("g", "mg")
    assert parse("sensors.scan_mirrored=true,false").values == (True, False)


def test_a_range_without_steps_is_for_a_search():
    """It has any value between its ends, by factors if it is logarithmic; alone it is refused."""
    axis = parse("fusion.omega=0.01:0.5:log")
    assert [axis.at(share) for share in (0.0, 0.5, 1.0)] == [0.01, 0.07071, 0.5]
    assert [parse("map.levels=1:3").at(share) for share in (0.0, 0.5, 0.99)] == [1, 2, 3]
    assert [parse("map.levels=1,3").at(share) for share in (0.0, 0.49, 0.5, 0.99)] == [1, 1, 3, 3]
    with pytest.raises(VaryError, match=r"fusion.omega is a range without steps: add a count"):
        list(combinations([axis]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("matcher.sigma", "gives no value"),
        ("matcher.sigma=", "gives no value"),
        ("matcher.sigmo=1", "did you mean matcher.sigma"),
        ("matcher.sigma=99", "give 0.0"),
        ("matcher.sigma=0.1,x", "give a finite number"),
        ("matcher.sigma=0.4:0.1:3", "is no range"),
        ("fusion.method=fixed:kalman:2", "is no range"),
        ("aiding.gate=0:9:log3", "above 0"),
        ("matcher.sigma=0.1:0.4:1", "1 steps"),
        ("matcher.sigma=0.1:0.4:9999999", "steps"),
        ("sensors.scan_dely=1", "did you mean sensors.scan_delay"),
        ("sensors.imu_accel_unit=miles", "give m/s2 or g or mg"),
        ("sensors.scan_mirrored=1", "sensors.scan_mirrored = 1.0: give true or false"),
        ("sensors.imu_accel_unit=" + "9" * 400, "sensors.imu_accel_unit = inf: give m/s2"),
        ("sensors.scan_topic=/a", "no sensor option"),
    ],
)
def test_what_is_not_understood_is_refused(text: str, message: str):
    """With the value, and what would do."""
    with pytest.raises(SlamError, match=message):
        parse(text)


def test_combinations_are_all_of_them_in_order():
    """The last axis is the fastest."""
    axes = [Axis("a", (1, 2)), Axis("b", ("x", "y"))]
    assert [tuple(each.values()) for each in combinations(axes)] == [(1, "x"), (1, "y"), (2, "x"), (2, "y")]
    assert list(combinations([])) == [{}]
    with pytest.raises(VaryError, match="combine to 1000000"):
        list(combinations([Axis("a", tuple(range(1000))), Axis("b", tuple(range(1000)))]))


def test_a_setting_is_varied_once():
    """Two lists for one setting contradict each other."""
    with pytest.raises(VaryError, match=r"matcher.sigma is given 2 times"):
        check_axes([parse("matcher.sigma=0.1"), parse("matcher.sigma=0.2")])

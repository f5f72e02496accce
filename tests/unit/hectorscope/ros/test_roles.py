"""Which topic plays which part."""

import pytest

from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.ros.roles import (
    FIX,
    IMU,
    MAGNETIC,
    ODOMETRY,
    POINT,
    POSE,
    PRESSURE,
    RANGE,
    SCAN,
    TWIST,
    TWIST_COVARIANCE,
    Topic,
    check_overrides,
    choose_roles,
)
from hectorscope.ros.roles import tf_spec as parse

TF = "tf2_msgs/msg/TFMessage"
OFFER = [
    Topic("/front/scan", SCAN, 213, 761),
    Topic("/nav/scan", SCAN, 204, 1440),
    Topic("/imu/data", IMU, 100),
    Topic("/odom", ODOMETRY, 50),
    Topic("/ground_truth/odom", ODOMETRY, 500),
    Topic("/goal", POSE, 3),
    Topic("/tf", TF, 10),
    Topic("/tf_static", TF, 1),
]


def test_parts_are_found_by_type() -> None:
    """Scan, IMU, odometry, truth and tf are found without being named; attitude is only on request."""
    roles = choose_roles(OFFER, SourceOptions())
    assert (roles.imu, roles.odometry, roles.truth) == ("/imu/data", "/odom", "/ground_truth/odom")
    assert (roles.attitude, roles.height) == (None, None)
    assert roles.transforms == ("/tf", "/tf_static")
    assert roles.topics() == {
        "/nav/scan", "/imu/data", "/odom", "/ground_truth/odom", "/tf", "/tf_static",
    }  # fmt: skip


def test_of_two_scanners_the_one_with_more_beams_is_taken_and_told() -> None:
    """Fewer messages with many more beams say more; the note names the choice and the way out."""
    roles = choose_roles(OFFER, SourceOptions())
    assert roles.scan == "/nav/scan"
    assert roles.notes == (
        "/nav/scan gives the most beams of 2 scanners: --scan-topic takes another (/front/scan)",
    )
    chosen = choose_roles(OFFER, SourceOptions(scan_topic="/front/scan"))
    assert (chosen.scan, chosen.notes) == ("/front/scan", ())


def test_a_missing_slash_is_no_difference() -> None:
    """`scan` finds /scan and /scan finds `scan`; the recording's own spelling is kept."""
    options = SourceOptions(scan_topic="front/scan")
    check_overrides(OFFER, options)
    assert choose_roles(OFFER, options).scan == "/front/scan"
    assert choose_roles([Topic("scan", SCAN)], SourceOptions(scan_topic="/scan")).scan == "scan"


@pytest.mark.parametrize(
    ("topic", "height"),
    [
        (Topic("/pressure", PRESSURE), "/pressure"),
        (Topic("/altitude", POINT), "/altitude"),
        (Topic("/clicked_point", POINT), None),
    ],
)
def test_height_is_taken_when_it_is_clearly_height(topic: Topic, height: str | None) -> None:
    """A barometer always is; points only by their name."""
    assert choose_roles([topic], SourceOptions()).height == height


@pytest.mark.parametrize(
    ("role", "topic", "taken"),
    [
        ("magnetic", Topic("/imu/mag", MAGNETIC), True),
        ("gps", Topic("/navsat", FIX), True),
        ("gps", Topic("/truth/fix", FIX), False),
        ("gps_velocity", Topic("/fix_velocity", TWIST_COVARIANCE), True),
        ("gps_velocity", Topic("/gps/vel", TWIST), True),
        ("gps_velocity", Topic("/cmd_vel", TWIST), False),
        ("ground", Topic("/height", RANGE), True),
        ("ground", Topic("/range_down", RANGE), True),
        ("ground", Topic("/sonar_left", RANGE), False),
    ],
)
def test_aids_are_taken_when_they_are_clearly_that(role: str, topic: Topic, taken: bool) -> None:
    """Types that serve many purposes only by their name; each can be asked for by its flag."""
    assert (getattr(choose_roles([topic], SourceOptions()), role) == topic.name) == taken
    options = SourceOptions(**{f"{role}_topic": topic.name})
    check_overrides([topic], options)
    assert getattr(choose_roles([topic], options), role) == topic.name
    assert topic.name in choose_roles([topic], options).topics()


def test_the_flag_of_a_role_of_two_words_is_named_rightly() -> None:
    """With dashes, as it is typed."""
    with pytest.raises(SourceError, match="--gps-velocity-topic takes one of"):
        check_overrides(OFFER, SourceOptions(gps_velocity_topic="/odom"))


@pytest.mark.parametrize("name", ["/pose_ground_truth", "/vrpn_client_node/jackal/pose", "/Vicon/robot", "/mocap"])
def test_truth_is_known_by_its_name(name: str) -> None:
    """Poses of a motion capture or a simulator are; a goal is not."""
    assert choose_roles([Topic(name, POSE)], SourceOptions()).truth == name
    assert choose_roles([Topic("/goal", POSE)], SourceOptions()).truth is None


def test_an_unknown_topic_lists_what_there_is() -> None:
    """The message names the topic, the option and the topics that would do."""
    with pytest.raises(SourceError) as error:
        check_overrides(OFFER, SourceOptions(scan_topic="/laser"))
    assert str(error.value) == (
        "there is no topic '/laser': --scan-topic takes one of sensor_msgs/LaserScan (/front/scan, /nav/scan)"
    )


def test_a_topic_of_the_wrong_type_is_told_apart_from_a_missing_one() -> None:
    """The message names the type that the topic has."""
    with pytest.raises(SourceError, match="topic '/odom' is a nav_msgs/msg/Odometry: --imu-topic takes one of"):
        check_overrides(OFFER, SourceOptions(imu_topic="/odom"))


def test_a_chain_of_transforms_can_stand_for_truth_and_attitude() -> None:
    """tf:PARENT>CHILD is taken for these two, is no topic to read, and nothing else may be so named."""
    options = SourceOptions(truth_topic="tf:map>base_link", attitude_topic="tf:/odom > /base_link")
    check_overrides(OFFER, options)
    roles = choose_roles(OFFER, options)
    assert roles.truth == "tf:map>base_link"
    assert not any(topic.startswith("tf:") for topic in roles.topics())
    assert str(parse("tf:/odom>/base_link")) == "tf:odom>base_link"
    with pytest.raises(SourceError, match="write tf:PARENT>CHILD"):
        parse("tf:map")
    with pytest.raises(SourceError, match="there is no topic"):
        check_overrides(OFFER, SourceOptions(scan_topic="tf:a>b"))


def test_a_chain_of_transforms_needs_transforms() -> None:
    """Where no topic has any, it is refused as any topic that is missing."""
    with pytest.raises(SourceError, match="tf:a>b needs transforms, but no topic has any"):
        check_overrides(OFFER[:-2], SourceOptions(truth_topic="tf:a>b"))


@pytest.mark.parametrize(("wanted", "near"), [("/front/scna", "/front/scan"), ("/robot/nav/scan", "/nav/scan")])
def test_a_mistyped_topic_gets_the_nearest_one(wanted: str, near: str) -> None:
    """Of those that would do for the part."""
    with pytest.raises(SourceError, match=rf"there is no topic '{wanted}' \(did you mean .*{near}\?\)"):
        check_overrides(OFFER, SourceOptions(scan_topic=wanted))

"""From bytes to messages."""

import struct

import pytest

from hectorscope.ros.decode import BadDefinition, decoder, ros2_name
from hectorscope.ros.messages import BadMessage
from tests.ros_messages import Messages

IDL = "module a { module msg { struct B { double x; }; }; };"


def test_standard_types_need_no_definition() -> None:
    """A scan of either generation is decoded by name alone, and so is ROS 1's tf."""
    for generation in ("ros1", "ros2"):
        ros = Messages(generation)
        scan = ros.scan(5)
        serialise = ros.store.serialize_ros1 if ros.ros1 else ros.store.serialize_cdr
        decode = decoder(generation, "sensor_msgs/msg/LaserScan")
        assert decode is not None
        assert decode(serialise(scan, scan.__msgtype__)).ranges.tolist() == [1.0, 2.0, 3.0]
    assert decoder("ros1", "tf2_msgs/msg/TFMessage") is not None
    assert decoder("ros1", "tf/msg/tfMessage") is not None


def test_a_definition_that_came_along_is_used() -> None:
    """Types that nobody knows are decoded by their own text, as msg or IDL."""
    decode = decoder("ros2", "my_msgs/msg/Speed", "float64 value")
    assert decode is not None
    assert decode(bytes([0, 1, 0, 0]) + bytes(6) + b"\xf0\x3f").value == 1.0
    for text in (IDL, f"{'=' * 80}\nIDL: a/msg/B\n{IDL}"):
        assert decoder("ros2", "a/msg/B", text, "idl") is not None
    assert decoder("ros2", "my_msgs/msg/Speed") is None


@pytest.mark.parametrize("text", ["flo at64 x!", "my_msgs/Missing thing"])
def test_a_broken_definition_of_a_standard_type_does_no_harm(text: str) -> None:
    """What cannot be parsed, or leaves out a type, gives way to the standard type."""
    ros = Messages("ros2")
    scan = ros.scan(5)
    decode = decoder("ros2", scan.__msgtype__, text)
    assert decode is not None
    assert len(decode(ros.store.serialize_cdr(scan, scan.__msgtype__)).ranges) == 3


def test_two_definitions_of_one_name_live_side_by_side() -> None:
    """Every channel is decoded by its own definition."""
    one, two = decoder("ros1", "my/msg/A", "uint8 x"), decoder("ros1", "my/msg/A", "uint8 x\nuint8 y")
    assert one is not None
    assert two is not None
    assert one(b"\x01").x == 1
    assert two(b"\x01\x02").y == 2


def test_a_standard_type_that_was_changed_is_read_by_its_definition() -> None:
    """Other fields first: the definition that came along tells, not the name."""
    changed = (
        "geometry_msgs/Vector3 angular_velocity\nstd_msgs/Header header\nfloat32[9] orientation_covariance\n"
        "geometry_msgs/Quaternion orientation\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
        f"{'=' * 80}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
        f"{'=' * 80}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
        f"{'=' * 80}\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    )
    decode = decoder("ros1", "sensor_msgs/msg/Imu", changed)
    assert decode is not None
    doubles = struct.pack("<3d", 1.0, 2.0, 3.0)
    message = decode(doubles + bytes(16) + bytes(36 + 32 + 72 + 24 + 72))
    assert message.angular_velocity.z == 3.0
    assert message.header.frame_id == ""


PARTS = {
    "sensor_msgs/Imu": "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
    "float64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
}


# Each is made of two of the next: the first of 2^40 numbers.
WIDE = {f"Wide{i}": f"my/Wide{i + 1} a\nmy/Wide{i + 1} b\n" for i in range(40)} | {"Wide40": "float64 x\n"}


def imu_definition(**changes: str) -> str:
    """The definition of an Imu, with other text for some of its types (by their last name)."""
    texts = {name: changes.get(name.rpartition("/")[2], text) for name, text in PARTS.items()}
    texts |= {f"my/{name}": text for name, text in changes.items() if name not in str(PARTS)}
    first, *others = texts.items()
    return first[1] + "".join(f"{'=' * 80}\nMSG: {name}\n{text}" for name, text in others)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"Vector3": "float64 x\nfloat64 z\n"}, r"no angular_velocity\.y"),
        ({"Vector3": "float64 x\nstring y\nfloat64 z\n"}, r"angular_velocity\.y of another kind"),
        ({"Vector3": "float64[] x\nfloat64 y\nfloat64 z\n"}, r"angular_velocity\.x of another kind"),
        ({"Header": "uint32 seq\nfloat64 stamp\nstring frame_id\n"}, r"header\.stamp"),
        ({"Imu": PARTS["sensor_msgs/Imu"] + "string[2000000000] more\n"}, "2000000000 values of more"),
        ({"Imu": PARTS["sensor_msgs/Imu"] + "my/Void[] more\n", "Void": ""}, "a list more of nothing"),
        ({"Imu": PARTS["sensor_msgs/Imu"] + "my/Loop more\n", "Loop": "my/Loop[] again\n"}, "contains itself"),
        ({"Imu": PARTS["sensor_msgs/Imu"] + "my/Wide0 more\n", **WIDE}, "more than 10000 fields"),
        ({"Imu": PARTS["sensor_msgs/Imu"] + "# " + 300_000 * "x"}, "too long"),
    ],
    ids=["missing", "string", "list", "nested", "array", "nothing", "cycle", "wide", "long"],
)
def test_a_definition_that_contradicts_its_name_is_refused(changes: dict[str, str], reason: str) -> None:
    """With the field, before any message is decoded by it."""
    assert decoder("ros1", "sensor_msgs/msg/Imu", imu_definition()) is not None
    with pytest.raises(BadDefinition, match=reason):
        decoder("ros1", "sensor_msgs/msg/Imu", imu_definition(**changes))


@pytest.mark.parametrize("raw", [b"", b"\x00\x01\x00\x00", b"\xff" * 200])
def test_bytes_that_do_not_fit_are_a_bad_message(raw: bytes) -> None:
    """Cut and garbled messages say which type they are not."""
    for generation in ("ros1", "ros2"):
        decode = decoder(generation, "sensor_msgs/msg/LaserScan")
        assert decode is not None
        with pytest.raises(BadMessage, match="bytes that are no sensor_msgs/msg/LaserScan"):
            decode(raw)


def test_old_type_names_are_brought_up_to_date() -> None:
    """pkg/Name is pkg/msg/Name; the new form stays."""
    assert ros2_name("sensor_msgs/Imu") == ros2_name("sensor_msgs/msg/Imu") == "sensor_msgs/msg/Imu"
    assert ros2_name("Imu") == "Imu"

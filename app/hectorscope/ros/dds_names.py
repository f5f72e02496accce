"""The names that ROS 2 gives its topics and message types in DDS; rmw_zenoh keeps those of the types."""

PREFIX = "rt/"  # of topics; services and parameters have others


def dds_topic(topic: str) -> str:
    """rt/scan for /scan."""
    return PREFIX + topic.removeprefix("/")


def ros_topic(name: str) -> str | None:
    """The topic /scan for rt/scan; None for what is no topic of ROS."""
    return "/" + name.removeprefix(PREFIX) if name.startswith(PREFIX) else None


def dds_type(msgtype: str) -> str:
    """sensor_msgs::msg::dds_::LaserScan_ for sensor_msgs/msg/LaserScan."""
    package, group, name = msgtype.split("/")
    return f"{package}::{group}::dds_::{name}_"


def ros_type(name: str) -> str | None:
    """The message type sensor_msgs/msg/LaserScan for sensor_msgs::msg::dds_::LaserScan_; None for other types."""
    parts = name.removesuffix("_").split("::")
    if len(parts) != 4 or parts[2] != "dds_" or not name.endswith("_"):
        return None
    return f"{parts[0]}/{parts[1]}/{parts[3]}"

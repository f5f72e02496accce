"""Topics of ROS 2 as those offer them who tell the hash of a type in the place of its definition."""

from hectorscope.ros.decode import definition_of
from hectorscope.sources._offers import Malformed, Offer


def ros2_offer(number: int, topic: str, msgtype: str, type_hash: str) -> Offer | Malformed:
    """A topic with the definition that its hash names, which may be of another ROS 2 than the standard one.

    type_hash: "" for a robot that does not tell it, as those with ROS 2 Humble.
    """
    definition = definition_of(msgtype, type_hash) if type_hash else ""
    if definition is None:
        return Malformed(f"{topic}: its {msgtype} is that of no ROS 2 that is known")
    return Offer(number, topic, "cdr", msgtype, definition)

"""Topics for ROS 2 by DDS: one more participant of the robot's domain."""

from typing import Any

from hectorscope.publishing import BusKind, PublishError
from hectorscope.results import ros_messages
from hectorscope.results.topics import DEPTHS, LATCHED, TOPICS, Message
from hectorscope.ros.dds import BARRED, FORM, domain, quality, raw_type, user_data
from hectorscope.ros.dds_names import dds_topic


class DdsBus:
    """A writer for each topic. Of a reader that is too slow, the oldest messages are lost."""

    def __init__(self, uri: str) -> None:
        """PublishError for an address of another form, a domain that cannot be joined, or without the library."""
        found = domain(uri, PublishError)
        from cyclonedds.core import DDSException  # noqa: PLC0415 - of the extra `dds`
        from cyclonedds.domain import DomainParticipant  # noqa: PLC0415

        try:
            participant = DomainParticipant(found)
        except DDSException as error:
            raise PublishError(f"{uri} {BARRED}") from error
        self._writers = {topic: _writer(participant, topic, msgtype) for topic, msgtype in TOPICS.items()}

    def wants(self, topic: str) -> bool:
        """Whether a node has subscribed to it; the last map is kept for those that come."""
        return topic in LATCHED or bool(self._writers[topic].get_matched_subscriptions())

    def publish(self, message: Message) -> None:
        """To the nodes that have subscribed."""
        if self.wants(message.topic):
            self._writers[message.topic].write(raw_type(TOPICS[message.topic])(message.content))

    def close(self) -> None:
        """Leave the domain: DDS objects end with the last reference to them."""
        self._writers = {}


def _writer(participant: Any, topic: str, msgtype: str) -> Any:
    from cyclonedds.pub import DataWriter  # noqa: PLC0415
    from cyclonedds.qos import Policy, Qos  # noqa: PLC0415
    from cyclonedds.topic import Topic  # noqa: PLC0415

    offered = quality(is_reliable=True, is_latched=topic in LATCHED, depth=DEPTHS.get(topic, 1))
    told = Policy.Userdata(user_data(ros_messages.STORE.hash_rihs01(msgtype)))
    known = Topic(participant, dds_topic(topic), raw_type(msgtype))
    return DataWriter(participant, known, qos=Qos(*offered, told))


BUS = BusKind(FORM, DdsBus)

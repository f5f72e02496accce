"""The keys of rmw_zenoh."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.ros.decode import definition_of
from hectorscope.ros.rmw_zenoh import Publication, announced, attachment, publication, sent_ns, token_of

HEAD = "@ros2_lv/7/aac3178e146ba6f1/0/10/MP/%/%robot/talker"
HASH = "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"


def test_a_publisher_tells_its_topic() -> None:
    """With the key of its messages, in which the topic's slashes stand as they are."""
    found = publication(f"{HEAD}/%robot%scan/sensor_msgs::msg::dds_::LaserScan_/{HASH}/::,7:,:,:,,")
    key = f"7/robot/scan/sensor_msgs::msg::dds_::LaserScan_/{HASH}"
    assert found == Publication("/robot/scan", "sensor_msgs/msg/LaserScan", HASH, key, is_latched=False)


def test_a_latched_topic_is_told() -> None:
    """By the durability among its qualities of service."""
    found = publication(f"{HEAD}/%tf_static/tf2_msgs::msg::dds_::TFMessage_/{HASH}/:1:,1:,:,:,,")
    assert found is not None
    assert found.is_latched


@pytest.mark.parametrize("token", ["", "@ros2_lv/0/a/0/10/NN/%/%/talker", HEAD.replace("MP", "MS") + "/%a/b/c/d"])
def test_what_is_no_publisher_is_passed_over(token: str) -> None:
    """Nodes, subscribers and services announce themselves alike."""
    assert publication(token) is None


@given(st.text(max_size=200))
def test_no_token_raises(token: str) -> None:
    """Whatever is announced."""
    publication(token)


def test_the_time_of_a_message_is_the_publishers() -> None:
    """It stands behind the message's number."""
    assert sent_ns(struct.pack("<qq", 5, 1_700_000_000_000_000_000) + bytes(17)) == 1_700_000_000_000_000_000
    assert sent_ns(b"short") is None
    assert sent_ns(None) is None


def test_a_type_is_found_by_its_hash() -> None:
    """In each distribution; an unknown hash of a known type is told from an unknown type."""
    definition = definition_of("sensor_msgs/msg/LaserScan", HASH)
    assert definition is not None
    assert "float32[] ranges" in definition
    assert definition_of("sensor_msgs/msg/LaserScan", "RIHS01_0") is None
    assert definition_of("some_msgs/msg/Other", "RIHS01_0") == ""


@pytest.mark.parametrize("is_latched", [False, True])
def test_what_we_announce_is_read_back(is_latched: bool) -> None:
    """A token says the same to others as it does to us."""
    ours = announced(7, "/robot/map", "nav_msgs/msg/OccupancyGrid", HASH, is_latched=is_latched)
    assert publication(token_of(ours, "aac3178e146ba6f1", 10, "hectorscope", 1)) == ours


def test_what_we_attach_is_read_back() -> None:
    """The time of a message; with the identity of its publisher it takes 33 bytes."""
    attached = attachment(3, 12345, bytes(16))
    assert sent_ns(attached) == 12345
    assert len(attached) == 33

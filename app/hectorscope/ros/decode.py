"""Bytes to messages: the standard types of both ROS generations, and what a recording or bridge defines itself."""

import re
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, Literal

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from hectorscope.ros.layouts import quick_reader
from hectorscope.ros.messages import BadMessage

Generation = Literal["ros1", "ros2"]
DefinitionFormat = Literal["msg", "idl"]
Decode = Callable[[bytes | memoryview], Any]

# A definition in IDL lists its files under headings like this.
_IDL_HEADING = re.compile(r"^=+\nIDL: .*\n", re.MULTILINE)


def ros2_name(msgtype: str) -> str:
    """sensor_msgs/LaserScan as sensor_msgs/msg/LaserScan."""
    package, _, name = msgtype.partition("/")
    return msgtype if "/" in name or not name else f"{package}/msg/{name}"


@lru_cache(maxsize=64)
def decoder(
    generation: Generation, msgtype: str, definition: str = "", form: DefinitionFormat = "msg"
) -> Decode | None:
    """A function from serialised bytes to a rosbags object; it raises BadMessage for bytes that do not fit.

    definition: the text that came with the data; without one, or where it cannot be parsed, the standard type of
    that name is used. None: the type is unknown. Each decoder keeps its own types, so that two definitions of one
    name do not get in each other's way.
    """
    standard = _standard(generation)
    store = (_defined(msgtype, definition, form) if definition else None) or standard
    if msgtype not in store.fielddefs:
        return None
    if not _field_names(standard, msgtype) <= _field_names(store, msgtype):
        return None
    deserialise = store.deserialize_ros1 if generation == "ros1" else store.deserialize_cdr

    def decode(raw: bytes | memoryview) -> Any:
        try:
            return deserialise(raw, msgtype)
        except (SerdeError, ValueError, IndexError) as error:
            raise BadMessage(f"bytes that are no {msgtype}") from error

    quick = quick_reader(msgtype, ros1=generation == "ros1")
    if quick is None or not _same(store, standard, msgtype):
        return decode
    return lambda raw: quick(raw) or decode(raw)


def _defined(msgtype: str, definition: str, form: DefinitionFormat) -> Typestore | None:
    """The types of a definition; None where it is missing, cannot be parsed or leaves out a type it uses."""
    store = get_typestore(Stores.EMPTY)
    try:
        if form == "msg":
            store.register(get_types_from_msg(definition, msgtype))
        else:
            for part in filter(None, _IDL_HEADING.split(definition)):
                store.register(get_types_from_idl(part))
        store.get_msgdef(msgtype)
    except (TypesysError, KeyError):
        return None
    return store


def _same(one: Typestore, other: Typestore, msgtype: str) -> bool:
    """Whether two stores agree about a type, down to the numbers it is made of."""
    if one is other:
        return True
    fields = one.fielddefs[msgtype][1]
    names = re.findall(r"[\w]+/msg/[\w]+", str(fields))
    return fields == other.fielddefs[msgtype][1] and all(_same(one, other, name) for name in names)


def _field_names(store: Typestore, msgtype: str) -> set[str]:
    """The fields of a type; none for a type that the store does not know."""
    return {name for name, _ in store.fielddefs[msgtype][1]} if msgtype in store.fielddefs else set()


@cache
def _standard(generation: Generation) -> Typestore:
    """Recordings without definitions are of Humble or older; the ROS 1 types lack tf2_msgs."""
    if generation == "ros2":
        return get_typestore(Stores.ROS2_HUMBLE)
    store = get_typestore(Stores.ROS1_NOETIC)
    for name in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
    return store

"""Bytes to messages: the standard types of both ROS generations, and what a recording or bridge defines itself."""

import re
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, Literal

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from hectorscope.ros.layouts import quick_reader
from hectorscope.ros.messages import BadMessage

Generation = Literal["ros1", "ros2"]
DefinitionFormat = Literal["msg", "idl"]
Decode = Callable[[bytes | memoryview], Any]
Types = dict[str, Any]

LONGEST_DEFINITION = 200_000  # characters
LONGEST_ARRAY = 10_000  # values of a fixed number; the standard types have 36 at most
MOST_FIELDS = 10_000  # of a type with all that it is made of; the standard types have some ten


class BadDefinition(Exception):
    """A definition that is not that of the type it names; the text is the reason."""


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
    that name is used. None: the type is unknown. BadDefinition: it contradicts the standard type of its name, on
    whose fields everything relies, or cannot be used. Each decoder keeps its own types, so that two definitions of
    one name do not get in each other's way.
    """
    standard = standard_types(generation)
    store = (_defined(msgtype, definition, form, standard) if definition else None) or standard
    if msgtype not in store.fielddefs:
        return None
    is_standard = store is standard
    if not is_standard and msgtype in standard.fielddefs:
        _check(store, standard, msgtype)
    deserialise = store.deserialize_ros1 if generation == "ros1" else store.deserialize_cdr

    def decode(raw: bytes | memoryview) -> Any:
        try:
            return deserialise(raw, msgtype)
        except (SerdeError, ValueError, IndexError) as error:
            raise BadMessage(f"bytes that are no {msgtype}") from error

    if not is_standard:
        _try(decode, msgtype)
    quick = quick_reader(msgtype, ros1=generation == "ros1") if is_standard else None
    return decode if quick is None else lambda raw: quick(raw) or decode(raw)


def _defined(msgtype: str, definition: str, form: DefinitionFormat, standard: Typestore) -> Typestore | None:
    """The types of a definition: the standard ones where it says the same.

    None: it cannot be parsed or leaves out a type it uses. BadDefinition: it cannot be one, or cannot be read.
    """
    if len(definition) > LONGEST_DEFINITION:
        raise BadDefinition(f"its definition of {msgtype} is too long to be one")
    store = get_typestore(Stores.EMPTY)
    try:
        types = _parsed(msgtype, definition, form)
        if _is_standard(types, standard, msgtype):
            return standard
        _check_size(types, msgtype)
        store.register(types)
        store.get_msgdef(msgtype)
    except BadDefinition:
        raise
    except (TypesysError, KeyError):
        return None
    except Exception as error:  # text from a stranger has many ways to be no definition
        raise BadDefinition(f"its definition of {msgtype} cannot be read") from error
    return store


def _parsed(msgtype: str, definition: str, form: DefinitionFormat) -> Types:
    """The types of a text, by name."""
    if form == "msg":
        return get_types_from_msg(definition, msgtype)
    types: Types = {}
    for part in filter(None, _IDL_HEADING.split(definition)):
        types |= get_types_from_idl(part)
    return types


def _try(decode: Decode, msgtype: str) -> None:
    """Decode nothing: the library writes code from the definition for that, which names in it may spoil."""
    try:
        decode(b"")
    except BadMessage:
        return
    except Exception as error:
        raise BadDefinition(f"its definition of {msgtype} cannot be used ({type(error).__name__})") from error


def _check_size(types: Types, msgtype: str, above: tuple[str, ...] = ()) -> int:
    """The number of fields with those of nested types.

    BadDefinition for types in a circle or of too many fields, and for lists whose length says nothing about the
    bytes they take.
    """
    if msgtype in above:
        raise BadDefinition(f"its definition of {above[0]} contains itself")
    count = 0
    for name, (node, value) in types[msgtype][1]:
        if node is Nodetype.ARRAY and int(value[1]) > LONGEST_ARRAY:
            raise BadDefinition(f"its definition has {value[1]} values of {name}, more than {LONGEST_ARRAY}")
        count += 1
        nested = _nested((node, value))
        if nested not in types:
            continue  # a number, or a type that is found to be missing elsewhere
        if node is Nodetype.SEQUENCE and not types[nested][1]:
            raise BadDefinition(f"its definition has a list {name} of nothing")
        count += _check_size(types, nested, (*above, msgtype))
        if count > MOST_FIELDS:
            raise BadDefinition(f"its definition of {(*above, msgtype)[0]} has more than {MOST_FIELDS} fields")
    return count


def _check(store: Typestore, standard: Typestore, msgtype: str, own: str = "", path: str = "") -> None:
    """BadDefinition where a field of a standard type is missing or of another kind; more fields are welcome.

    own: the name that the type has in `store`, if it has another one. path: the fields that led to it.
    """
    fields = dict(store.fielddefs[own or msgtype][1])
    for name, wanted in standard.fielddefs[msgtype][1]:
        where, found = f"{path}{name}", fields.get(name)
        if found is None:
            raise BadDefinition(f"its definition of {msgtype} has no {where}")
        types, found_types = _nested(wanted), _nested(found)
        if _kind(wanted) != _kind(found) or bool(types) != bool(found_types):
            raise BadDefinition(f"its definition of {msgtype} has {where} of another kind")
        if types:
            _check(store, standard, types, found_types, f"{where}.")


def _nested(field: Any) -> str:
    """The type that a field is made of, alone or many; empty for numbers and text."""
    node, value = field
    if node is Nodetype.NAME:
        return str(value)
    return _nested(value[0]) if node in (Nodetype.ARRAY, Nodetype.SEQUENCE) else ""


def _kind(field: Any) -> tuple[str, ...]:
    """What code can rely on: number, text or type, alone or many. A float of either size will do."""
    node, value = field
    if node is Nodetype.NAME:
        return ("type",)
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return ("many", *_kind(value[0]))
    word: str = value[0]
    return ("float",) if word.startswith("float") else ("integer",) if "int" in word else (word,)


def _is_standard(types: Types, standard: Typestore, msgtype: str) -> bool:
    """Whether types agree with the standard about one of them, down to the numbers it is made of."""
    if msgtype not in types:
        return msgtype in standard.fielddefs
    if msgtype not in standard.fielddefs or types[msgtype][1] != standard.fielddefs[msgtype][1]:
        return False
    nested = filter(None, (_nested(field) for _, field in types[msgtype][1]))
    return all(_is_standard(types, standard, name) for name in nested)


def definition_of(msgtype: str, type_hash: str) -> str | None:
    """The definition of a message of ROS 2 by its hash (REP 2011, "RIHS01_..."); None if no distribution has it.

    "" for a type that is not known at all, whatever its hash: nothing here asks for it.
    """
    stores = [get_typestore(store) for store in (Stores.ROS2_JAZZY, Stores.ROS2_HUMBLE)]
    known = [store for store in stores if msgtype in store.fielddefs]
    found = next((store for store in known if store.hash_rihs01(msgtype) == type_hash), None)
    if found is None:
        return None if known else ""
    return found.generate_msgdef(msgtype, ros_version=2)[0]


@cache
def standard_types(generation: Generation) -> Typestore:
    """Recordings without definitions are of Humble or older; the ROS 1 types lack tf2_msgs."""
    if generation == "ros2":
        return get_typestore(Stores.ROS2_HUMBLE)
    store = get_typestore(Stores.ROS1_NOETIC)
    for name in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
    return store

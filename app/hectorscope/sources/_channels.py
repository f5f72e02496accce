"""The channels of a live stream: what is offered, what is wanted of it, and how that is decoded."""

import re
from dataclasses import fields, replace
from typing import Any

from hectorscope.inputs import Message, SourceError, SourceOptions
from hectorscope.ros.decode import LONGEST_DEFINITION, BadDefinition, Decode, Generation, decoder
from hectorscope.ros.foxglove_scan import ENCODINGS, SCHEMA, ToCdr, to_cdr
from hectorscope.ros.roles import ROLE_TYPES, SCAN, TF_TYPES, Roles, Topic, check_overrides, choose_roles
from hectorscope.sources._offers import Offer, Payload

# Names and definitions end up in generated code, so nothing but names may pass.
_TYPE_NAME = re.compile(r"([A-Za-z]\w*)/(?:msg/)?([A-Za-z]\w*)", re.ASCII)
_USABLE_TYPES = frozenset(name for names in (*ROLE_TYPES.values(), TF_TYPES) for name in names)


class ChannelError(Exception):
    """A channel that is needed cannot be decoded; the text gives the reason."""


class Channels:
    """What one connection offers. A topic that was given a part keeps it, whatever is offered later."""

    def __init__(self, options: SourceOptions) -> None:
        self.roles = Roles()
        self._options = options
        self.reset()

    def reset(self) -> None:
        """A new connection: its channels are numbered anew."""
        self._offers: dict[int, Offer] = {}
        self._decoders: dict[int, tuple[str, str, Decode]] = {}
        self._prepared: dict[int, Offer] = {}
        self._to_cdr: dict[int, ToCdr] = {}
        self._seen: set[int] = set()

    def add(self, offer: Offer) -> None:
        """A channel is there."""
        self._offers[offer.id] = offer

    def remove(self, channel: int) -> None:
        """A channel is gone; messages of it that are on their way are still decoded."""
        self._offers.pop(channel, None)
        self._seen.discard(channel)

    def refuse(self, offer: Offer) -> None:
        """A channel cannot be decoded: another one may take its parts, also one that is offered later."""
        del self._offers[offer.id]
        others = {message_type(other) for other in self._offers.values() if other.topic == offer.topic}
        freed: dict[str, Any] = {
            role: None
            for role, types in ROLE_TYPES.items()
            if getattr(self.roles, role) == offer.topic and others.isdisjoint(types)
        }
        self.roles = replace(self.roles, **freed)

    def decode(self, channel: int) -> tuple[str, str, Decode] | None:
        """Topic and type of a channel and the function for its messages; None if it was not asked for."""
        return self._decoders.get(channel)

    def message(self, payload: Payload) -> Message:
        """What came over a channel that was asked for, with all that it takes to read it later.

        A scan of Foxglove's schema becomes the ROS message that it stands for; BadMessage if it is none.
        """
        offer = self._prepared[payload.subscription]
        if convert := self._to_cdr.get(offer.id):
            return Message(offer.topic, "cdr", SCAN, "", "msg", payload.received_ns, convert(payload.data))
        return Message(
            offer.topic,
            offer.encoding,
            message_type(offer),
            offer.schema,
            offer.form,
            payload.received_ns,
            payload.data,
        )

    def choose(self) -> list[Offer]:
        """Give out the parts that are still vacant; the wanted channels that were not seen before."""
        self.roles = _filled(self.roles, choose_roles(self._topics(), self._options))
        topics = self.roles.topics()
        unseen = [offer for offer in self._offers.values() if offer.id not in self._seen]
        wanted = [o for o in unseen if o.topic in topics and message_type(o) in _USABLE_TYPES]
        self._seen.update(offer.id for offer in wanted)
        return wanted

    def prepare(self, offer: Offer) -> None:
        """Make ready for the messages of a wanted channel; ChannelError if they cannot be decoded."""
        if len(offer.schema) > LONGEST_DEFINITION:
            raise ChannelError(f"its definition of {offer.schema_name} is too long to be one")
        generation: Generation = "ros1" if offer.encoding == "ros1" else "ros2"
        definition = "" if is_foxglove_scan(offer) else offer.schema
        try:
            if is_foxglove_scan(offer):
                self._to_cdr[offer.id] = to_cdr(offer.encoding, offer.schema)
            decode = decoder(generation, message_type(offer), definition, offer.form)
        except BadDefinition as reason:
            raise ChannelError(str(reason)) from reason
        except Exception as error:  # text from a stranger has many ways to be no definition
            raise ChannelError(f"its definition of {offer.schema_name} cannot be read") from error
        if decode is None:
            raise ChannelError(f"its {offer.schema_name} is not known")
        self._decoders[offer.id] = offer.topic, message_type(offer), decode
        self._prepared[offer.id] = offer

    def missing(self) -> str:
        """What has to be offered yet before there is anything to see, with the remedy; empty if all is there."""
        topics = self._topics()
        try:
            check_overrides(topics, self._options)
        except SourceError as error:
            return str(error)
        if self.roles.scan is None:
            return f"none of the {len(topics)} topics is a LaserScan: start the laser's driver"
        if all(topic.name != self.roles.scan for topic in topics):
            return f"{self.roles.scan} was withdrawn: start the laser's driver again"
        return ""

    @property
    def offered(self) -> dict[str, str]:
        """The message types by their topics."""
        return {topic.name: topic.msgtype for topic in self._topics()}

    def _topics(self) -> list[Topic]:
        offers = list(self._offers.values())
        return [Topic(offer.topic, name) for offer in offers if (name := message_type(offer))]


def is_foxglove_scan(offer: Offer) -> bool:
    """Whether its messages are scans of Foxglove's own schema."""
    return offer.encoding in ENCODINGS and offer.schema_name == SCHEMA


def message_type(offer: Offer) -> str:
    """The ROS 2 style name of a channel's messages; empty for what is no ROS message."""
    if is_foxglove_scan(offer):
        return SCAN
    name = _TYPE_NAME.fullmatch(offer.schema_name)
    return f"{name[1]}/msg/{name[2]}" if name and offer.encoding in ("cdr", "ros1") else ""


def _filled(held: Roles, new: Roles) -> Roles:
    """`new`, where nobody holds the part; transforms are all welcome."""
    parts = {f.name: getattr(held, f.name) for f in fields(held) if isinstance(getattr(held, f.name), str)}
    transforms = (*held.transforms, *(topic for topic in new.transforms if topic not in held.transforms))
    return replace(new, **parts, transforms=transforms)

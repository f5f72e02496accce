"""What a live stream says, whatever its protocol: channels come and go, messages arrive."""

from dataclasses import dataclass

from hectorscope.ros.decode import DefinitionFormat


@dataclass(frozen=True, slots=True)
class Offer:
    """A channel that can be subscribed to: one topic in one encoding, "cdr" or "ros1" where it can be used.

    schema: the definition of its messages in the format `form`; "" for the standard one of that name.
    """

    id: int
    topic: str
    encoding: str
    schema_name: str
    schema: str = ""
    form: DefinitionFormat = "msg"


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """A channel that is no more."""

    id: int


@dataclass(frozen=True, slots=True)
class Payload:
    """One serialised message of a subscription. received_ns: when the other side got it, by its clock."""

    subscription: int
    received_ns: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Malformed:
    """Something that cannot be read."""

    reason: str


Event = Offer | Withdrawal | Payload | Malformed

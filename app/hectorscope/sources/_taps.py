"""Who hears the messages of a live stream as they came."""

from hectorscope.inputs import Message, Tap
from hectorscope.ros.roles import is_static_tf

MOST_STATIC = 256  # messages; a robot says its mounts once, to each who asks


class Taps:
    """The static transforms are kept: who comes later hears them first."""

    def __init__(self) -> None:
        self._taps: list[Tap] = []
        self._static: dict[tuple[str, bytes], Message] = {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Why messages are not kept, a sentence each."""
        return tuple(tap.warning for tap in self._taps if tap.warning)

    def add(self, tap: Tap) -> None:
        """One more."""
        for message in self._static.values():
            tap.take(message)
        self._taps.append(tap)

    def remove(self, tap: Tap) -> None:
        """One less."""
        self._taps.remove(tap)

    def hear(self, message: Message) -> None:
        """Tell all of them."""
        if is_static_tf(message.topic) and len(self._static) < MOST_STATIC:
            self._static.setdefault((message.topic, message.data), message)
        for tap in self._taps:
            tap.take(message)

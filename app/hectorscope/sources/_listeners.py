"""Who gets the messages of a live stream as they came."""

from hectorscope.inputs import Message, MessageListener
from hectorscope.ros.roles import is_static_tf

MOST_STATIC = 256  # messages; a robot says its mounts once, to each who asks


class Listeners:
    """The static transforms are kept: who comes later gets them first."""

    def __init__(self) -> None:
        self._listeners: list[MessageListener] = []
        self._static: dict[tuple[str, bytes], Message] = {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Why messages are not kept, a sentence each."""
        return tuple(listener.warning for listener in self._listeners if listener.warning)

    def add(self, listener: MessageListener) -> None:
        """One more."""
        for message in self._static.values():
            listener.take(message)
        self._listeners.append(listener)

    def remove(self, listener: MessageListener) -> None:
        """One less."""
        self._listeners.remove(listener)

    def take(self, message: Message) -> None:
        """Pass it on to all of them."""
        if is_static_tf(message.topic) and len(self._static) < MOST_STATIC:
            self._static.setdefault((message.topic, message.data), message)
        for listener in self._listeners:
            listener.take(message)

"""What the page and the engine pass each other."""

import threading
from queue import SimpleQueue

from hectorscope.session.commands import Command
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot


class Exchange:
    """Commands one way, the newest snapshot the other; for any number of threads.

    It is there before the engine, so that the page is served while the engine is made.
    """

    def __init__(self) -> None:
        self.mailbox: Mailbox[Snapshot] = Mailbox()
        self.commands: SimpleQueue[Command] = SimpleQueue()
        self.sent = 0
        self._sending = threading.Lock()

    def send(self, command: Command) -> None:
        """Enqueue a command; returns at once."""
        with self._sending:
            self.commands.put(command)
            self.sent += 1

"""The one owner of a running pipeline: drains commands, steps, publishes snapshots."""

from app.mailbox import Mailbox
from app.settings import Settings
from app.snapshot import Command, Snapshot
from app.sources import Source


class Engine:
    """Runs one source through the pipeline on a thread of its own.

    mailbox: the newest Snapshot; one is there from `start` on. The engine survives a failing source or core: it
    reports the state "failed" with the reason and can be restarted by Restart, Seek or Play.
    """

    mailbox: Mailbox[Snapshot]

    def __init__(
        self, source: Source, settings: Settings | None = None, *, autoplay: bool = True, speed: float = 1.0
    ) -> None:
        self.mailbox = Mailbox()

    def start(self) -> None:
        """Begin; a second call does nothing."""

    def send(self, command: Command) -> None:
        """Enqueue a command; returns at once, from any thread."""

    def stop(self) -> None:
        """End both threads, close the source, and wait for it."""

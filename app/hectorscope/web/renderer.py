"""The display thread: brings the newest snapshot to the page at a fixed rate, within a budget of time.

What is drawn in one turn reaches a browser as one message, at once.
Behind a jump to another time everything is drawn at once, whatever its rate: somebody waits for it.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from hectorscope.page.scene import Scene
from hectorscope.page.viser_private import one_message
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot

log = logging.getLogger(__name__)

RATE = 25.0  # Hz; a view or panel may ask for less by an attribute `rate`
FAILURES = 3  # in a row; then a view or panel is left out
IDLE_RATE = 2.0  # Hz, while no browser looks
BUDGET = 0.4 / RATE  # seconds a tick may draw; the rest waits for the next one, the longest waiting first


@dataclass(slots=True)
class Item:
    """A view or panel: drawn every `period` seconds, next at `due`. failed: how often in a row."""

    title: str
    draw: Callable[[Snapshot], None]
    period: float
    due: float = 0.0
    failed: int = 0


class Renderer:
    """Draws `items` (views and panels) until stopped. One that keeps raising is left out and named on the page."""

    def __init__(self, scene: Scene, mailbox: Mailbox[Snapshot], items: Iterable[Any]) -> None:
        self._scene = scene
        self._mailbox = mailbox
        self._items = [Item(i.title, i.draw, 1.0 / getattr(i, "rate", RATE)) for i in items]
        self._wake = threading.Event()
        self._stopping = False
        self._jumps = jumps(Snapshot())
        self._thread = threading.Thread(target=self._run, name="renderer", daemon=True)
        scene.server.on_client_connect(lambda _: self._wake.set())
        mailbox.tell(self._hear)

    def start(self) -> None:
        """Begin to draw."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread and wait for it."""
        self._stopping = True
        self._wake.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stopping:
            started = time.monotonic()
            self._wake.clear()
            self.tick(started)
            rate = RATE if self._scene.server.get_clients() else IDLE_RATE
            self._wake.wait(max(0.0, started + 1.0 / rate - time.monotonic()))

    def _hear(self, snapshot: Snapshot) -> None:
        if jumps(snapshot) != self._jumps:
            self._wake.set()

    def tick(self, now: float) -> None:
        """Draw what is due, the longest waiting first, until the budget is spent; behind a jump all of it."""
        snapshot = self._mailbox.latest or Snapshot()
        jumped, self._jumps = jumps(snapshot) != self._jumps, jumps(snapshot)
        ends = time.monotonic() + BUDGET
        due = sorted((item for item in self._items if item.due <= now), key=lambda item: item.due)
        with one_message(self._scene.server):
            for item in list(self._items) if jumped else due:
                self._draw(item, snapshot)
                # What is due once a second is so in the same turn: each message makes a browser draw for a while.
                item.due = (now // item.period + 1.0) * item.period
                if time.monotonic() > ends and not jumped:
                    break

    def _draw(self, item: Item, snapshot: Snapshot) -> None:
        try:
            item.draw(snapshot)
        except Exception as error:  # one broken view must not take the others away
            item.failed += 1
            if item.failed < FAILURES:  # a connection may have come or gone in this moment
                log.warning("%s was not drawn: %s", item.title, error)
                return
            log.exception("%s cannot be drawn any more", item.title)
            self._items.remove(item)
            self._scene.failures[item.title] = type(error).__name__
        else:
            item.failed = 0


def jumps(snapshot: Snapshot) -> tuple[int, int]:
    """Another one whenever a run has jumped, back or forward."""
    return snapshot.epoch, snapshot.playback.seeks

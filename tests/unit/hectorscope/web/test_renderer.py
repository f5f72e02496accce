"""The display thread's turn: what is due, within the budget, whatever fails."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import viser

from hectorscope.page.scene import Scene
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot
from hectorscope.web import renderer as module
from hectorscope.web.renderer import Renderer
from hectorscope.web.server import made


class Item:
    """Counts its drawings."""

    def __init__(self, title: str, rate: float = 25.0, act: Callable[[], None] = lambda: None) -> None:
        self.title, self.rate, self.act, self.drawn = title, rate, act, 0

    def draw(self, snapshot: Snapshot) -> None:
        """Count."""
        self.drawn += 1
        self.act()


def fail() -> None:
    raise ValueError("broken")


def make(
    server: viser.ViserServer, *items: Any, mailbox: Mailbox[Snapshot] | None = None
) -> tuple[Renderer, Scene]:
    scene = Scene(server, lambda command: None)
    return Renderer(scene, mailbox or Mailbox(), items), scene


def test_one_that_fails_is_left_out_and_named(server: viser.ViserServer) -> None:
    """The others go on; the broken one is tried three times and never again."""
    good, bad = Item("good"), Item("bad", act=fail)
    thread, scene = make(server, bad, good)
    for now in range(5):
        thread.tick(float(now))
    assert (good.drawn, bad.drawn) == (5, 3)
    assert scene.failures == {"bad": "ValueError"}


def test_what_is_drawn_in_one_turn_goes_together(server: viser.ViserServer) -> None:
    """A browser that draws in between would show the robot beside its scan."""
    held: list[int] = []
    buffer = server._websock_server._broadcast_buffer
    thread, _ = make(server, *[Item("one", act=lambda: held.append(buffer.atomic_counter)) for _ in range(2)])
    thread.tick(0.0)
    assert held == [1, 1]
    assert buffer.atomic_counter == 0


def test_one_that_fails_now_and_then_stays(server: viser.ViserServer) -> None:
    """A browser that comes or goes in the wrong moment takes no panel from the others."""
    item = Item("sometimes")
    item.act = lambda: fail() if item.drawn % 3 else None
    thread, scene = make(server, item)
    for now in range(9):
        thread.tick(float(now))
    assert item.drawn == 9
    assert scene.failures == {}


class Unmade(Item):
    """Fails while it is made."""

    title = "unmade"

    def __init__(self, scene: Scene) -> None:
        fail()


class Made(Item):
    """Is made."""

    def __init__(self, scene: Scene) -> None:
        super().__init__("made")


def test_one_that_cannot_be_made_is_left_out_and_named(server: viser.ViserServer) -> None:
    """A view that fails in its beginning does not take the page away."""
    scene = Scene(server, lambda command: None)
    assert [item.title for item in made([Unmade, Made], scene)] == ["made"]
    assert scene.failures == {"unmade": "ValueError"}


def test_each_is_drawn_at_its_own_rate(server: viser.ViserServer) -> None:
    """Ten ticks in a second draw a slow item five times."""
    slow, fast = Item("slow", rate=5.0), Item("fast")
    thread, _ = make(server, slow, fast)
    for tick in range(10):
        thread.tick(0.1 * tick)
    assert (slow.drawn, fast.drawn) == (5, 10)


def test_what_the_budget_leaves_out_comes_first_next_time(server: viser.ViserServer) -> None:
    """An item that uses up every tick cannot starve the others."""
    greedy, modest = Item("greedy", act=lambda: time.sleep(1.5 * module.BUDGET)), Item("modest")
    thread, _ = make(server, greedy, modest)
    thread.tick(0.0)
    assert (greedy.drawn, modest.drawn) == (1, 0)
    thread.tick(1.0)
    assert modest.drawn == 1


def test_all_is_drawn_behind_a_jump(server: viser.ViserServer) -> None:
    """Back or forward, whatever the rates and the budget; the next tick is one as ever."""
    mailbox: Mailbox[Snapshot] = Mailbox()
    greedy, slow = Item("greedy", act=lambda: time.sleep(1.5 * module.BUDGET)), Item("slow", rate=0.1)
    thread, _ = make(server, greedy, slow, mailbox=mailbox)
    for now, snapshot in enumerate(
        (
            Snapshot(),
            Snapshot(epoch=1),
            Snapshot(epoch=1, playback=replace(Snapshot().playback, seeks=1)),
        )
    ):
        mailbox.put(snapshot)
        thread.tick(0.1 * now)
    assert slow.drawn == 2
    thread.tick(0.3)
    assert slow.drawn == 2


def test_a_jump_is_not_waited_for(server: viser.ViserServer) -> None:
    """While nobody looks, it is drawn twice a second; a jump is drawn as it comes."""
    mailbox: Mailbox[Snapshot] = Mailbox()
    drawn: list[int] = []
    item = Item("item", rate=1e-3)
    item.draw = lambda snapshot: drawn.append(snapshot.epoch)  # type: ignore[method-assign]
    thread, _ = make(server, item, mailbox=mailbox)
    thread.start()
    try:
        for epoch in range(1, 4):
            mailbox.put(Snapshot(epoch=epoch))
            ends = time.monotonic() + 20.0
            while epoch not in drawn and time.monotonic() < ends:
                time.sleep(0.001)
    finally:
        thread.stop()
    assert drawn[-3:] == [1, 2, 3]

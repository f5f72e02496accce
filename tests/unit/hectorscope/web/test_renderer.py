"""The display thread's turn: what is due, within the budget, whatever fails."""

import time
from collections.abc import Callable
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


def make(server: viser.ViserServer, *items: Any) -> tuple[Renderer, Scene]:
    scene = Scene(server, lambda command: None)
    return Renderer(scene, Mailbox(), items), scene


def test_one_that_fails_is_left_out_and_named(server: viser.ViserServer) -> None:
    """The others go on; the broken one is drawn once and never again."""
    good, bad = Item("good"), Item("bad", act=fail)
    thread, scene = make(server, bad, good)
    for now in (0.0, 1.0, 2.0):
        thread.tick(now)
    assert (good.drawn, bad.drawn) == (3, 1)
    assert scene.failures == {"bad": "ValueError"}


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

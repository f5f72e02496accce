"""What is drawn in the scene. One file a thing; each has `VIEW`, a class with the `View` protocol."""

import sys
from typing import Protocol

from hectorscope.common.registry import members
from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot


class View(Protocol):
    """Draws one thing. Made once with the Scene; `draw` runs on the display thread.

    An attribute `rate` asks for fewer drawings a second than the display's own rate.
    """

    title: str

    def __init__(self, scene: Scene) -> None:
        """Make the scene nodes."""

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the scene up to date; cheap when nothing changed. Encode first, then assign to handles."""


def view_classes() -> list[type[View]]:
    """Every view of this folder."""
    return members(sys.modules[__name__], "VIEW")

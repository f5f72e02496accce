"""The controls and read-outs. One file a panel; each has `PANEL`, a class with the `Panel` protocol."""

import sys
from typing import Protocol

from hectorscope.common.registry import members
from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot


class Panel(Protocol):
    """One group of controls. `order` sorts the panels; callbacks only send commands."""

    title: str
    order: int

    def __init__(self, scene: Scene) -> None:
        """Make the controls."""

    def draw(self, snapshot: Snapshot) -> None:
        """Bring the read-outs up to date; runs on the display thread."""


def panel_classes() -> list[type[Panel]]:
    """Every panel of this folder, in order."""
    return sorted(members(sys.modules[__name__], "PANEL"), key=lambda panel: panel.order)

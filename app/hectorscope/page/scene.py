"""What views and panels are made with: scene and GUI of the page, display settings, commands to the engine."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, get_args

import numpy as np
import viser

from hectorscope.page import viser_private
from hectorscope.page.theme import DARK, LIGHT, Theme
from hectorscope.session.commands import Command

Layout = Literal["stacked", "side", "one"]
Points = Literal["residual", "height", "plain"]
Camera = Literal["free", "follow", "top", "fit"]

NOTICE_S = 8.0  # seconds that a notice stays
GAP_RANGE = (0.05, 2.0)  # between stacked levels, times the depth of the map
ELLIPSE_SCALE_RANGE = (1.0, 2000.0)  # times one sigma


@dataclass(frozen=True, slots=True)
class Display:
    """How things are shown: shared by every browser, immutable. Views compare it with what they drew last.

    gap: between stacked levels, times the depth of the map. level: the one shown in layout "one", 0 the finest.
    ellipse_scale: the ellipses show this many sigmas. ellipse_fit: whether that follows the map and covariances.
    hidden: keys of the layers switched off.
    """

    layout: Layout = "stacked"
    gap: float = 0.5
    level: int = 0
    ellipse_scale: float = 200.0
    ellipse_fit: bool = True
    points: Points = "residual"
    dark: bool = True
    hidden: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Bring every value into its range: what comes from a browser is not trusted."""
        put = object.__setattr__
        put(self, "layout", self.layout if self.layout in get_args(Layout) else "stacked")
        put(self, "points", self.points if self.points in get_args(Points) else "residual")
        put(self, "gap", float(np.clip(self.gap, *GAP_RANGE)))
        put(self, "level", max(0, int(self.level)))
        put(self, "ellipse_scale", float(np.clip(self.ellipse_scale, *ELLIPSE_SCALE_RANGE)))

    @property
    def theme(self) -> Theme:
        """The colours that go with it."""
        return DARK if self.dark else LIGHT


@dataclass(frozen=True, slots=True)
class Layer:
    """Something that can be shown and hidden: `root` is the scene node that everything of it hangs below.

    colour: the field of Theme that a legend shows for it, "" when it has no single colour.
    """

    key: str
    title: str
    root: viser.FrameHandle
    colour: str = ""


@dataclass(slots=True)
class Scene:
    """What views and panels may use. Views are made before panels: `layers` is then complete.

    server: add nodes by `server.scene` and controls by `server.gui`. send: enqueues a command for the engine.
    floor: the node of the finest level's plane; it sinks when the robot goes below the height it started at.
    failures: title of a view or panel that raised and was switched off -> reason.
    """

    server: viser.ViserServer
    send: Callable[[Command], None]
    display: Display = field(default_factory=Display)
    layers: list[Layer] = field(default_factory=list)
    failures: dict[str, str] = field(default_factory=dict)
    floor: viser.FrameHandle = field(init=False)
    _lock: threading.RLock = field(default_factory=threading.RLock)

    def __post_init__(self) -> None:
        self.floor = self.server.scene.add_frame("/floor", show_axes=False)
        self._apply_theme()

    @property
    def theme(self) -> Theme:
        """The colours now; compare with `is` to notice a change."""
        return self.display.theme

    def layer(
        self, key: str, title: str, *, colour: str = "", on_floor: bool = False, shown: bool = True
    ) -> Layer:
        """A new layer; `title` is the label of its switch. on_floor: it lies on the plane of the finest level."""
        name = f"{self.floor.name if on_floor else ''}/{key}"
        root = self.server.scene.add_frame(name, show_axes=False, visible=shown)
        layer = Layer(key, title, root, colour)
        self.layers.append(layer)
        if not shown:
            self.show_layer(key, shown)
        return layer

    def show(self, **changes: Any) -> None:
        """Change display settings by name (fields of Display); values out of range are clamped. Any thread."""
        known = {f.name for f in fields(Display)}
        if unknown := changes.keys() - known:
            raise KeyError(f"Display has no {sorted(unknown)}: choose from {sorted(known)}")
        with self._lock:
            before, self.display = self.display, replace(self.display, **changes)
            for layer in self.layers:
                layer.root.visible = layer.key not in self.display.hidden
            if before.dark != self.display.dark:
                self._apply_theme()

    def show_layer(self, key: str, shown: bool) -> None:
        """Show or hide one layer."""
        with self._lock:
            hidden = self.display.hidden
            self.show(hidden=hidden - {key} if shown else hidden | {key})

    def camera(self, mode: Camera, client: viser.ClientHandle | None = None) -> None:
        """Point one browser's camera (every browser's when None): each person keeps a view of their own."""
        if mode in get_args(Camera):
            self.run(f"window.hectorscope?.camera('{mode}')", client)

    def notify(self, sentence: str) -> None:
        """Show a sentence in a corner of every open page, for some seconds."""
        for client in self.server.get_clients().values():
            client.add_notification("", sentence, auto_close_seconds=NOTICE_S)

    def run(self, script: str, client: viser.ClientHandle | None = None) -> None:
        """Run JavaScript once in one browser, or in all that are connected now; late joiners never see it.

        Scripts that every page needs belong to static/, which the page loads by itself.
        """
        for target in [client] if client is not None else list(self.server.get_clients().values()):
            viser_private.run_script(target, script)

    def _apply_theme(self) -> None:
        theme = self.theme
        self.server.gui.configure_theme(
            dark_mode=theme.dark, brand_color=theme.accent, show_logo=False, show_share_button=False
        )
        self.server.scene.set_background_image(np.array([[theme.background]], np.uint8), format="png")

"""What views and panels are made with: scene and GUI of the page, display settings, commands to the engine."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
import viser

from hectorscope.page import viser_private
from hectorscope.page.theme import SENT
from hectorscope.run.notes import Note
from hectorscope.session.commands import Command

if TYPE_CHECKING:
    from hectorscope.exporters import Exporter

Points = Literal["residual", "height", "plain"]
Camera = Literal["free", "follow", "top", "fit"]

NOTICE_S = 8.0  # seconds that a notice stays
ELLIPSE_SCALE_RANGE = (1.0, 2000.0)  # times one sigma


@dataclass(frozen=True, slots=True)
class Display:
    """How things are drawn for every browser alike, immutable. Views compare it with what they drew last.

    Theme, layout of the levels, layers and camera are each browser's own: static/ keeps them there.
    ellipse_scale: the ellipses show this many sigmas. ellipse_fit: whether that follows the map and covariances.
    asked: keys of the layers on demand that a browser has asked for.
    """

    ellipse_scale: float = 200.0
    ellipse_fit: bool = True
    points: Points = "residual"
    asked: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Bring every value into its range: what comes from a browser is not trusted."""
        put = object.__setattr__
        put(self, "points", self.points if self.points in get_args(Points) else "residual")
        put(self, "ellipse_scale", float(np.clip(self.ellipse_scale, *ELLIPSE_SCALE_RANGE)))


@dataclass(frozen=True, slots=True)
class Layer:
    """Something that each browser can show and hide: `root` is the node that everything of it hangs below.

    colour: the field of Theme that a legend shows for it, "" when it has no single colour. shown: whether a new
    browser shows it. on_demand: nothing of it is sent until a browser asks. more: other nodes that go with it.
    """

    key: str
    title: str
    root: viser.FrameHandle
    colour: str = ""
    shown: bool = True
    on_demand: bool = False
    more: tuple[str, ...] = ()


@dataclass(slots=True)
class Scene:
    """What views and panels may use. Views are made before panels: `layers` is then complete.

    server: add nodes by `server.scene` and controls by `server.gui`. send: enqueues a command for the engine.
    floor: the node of the finest level's plane; it sinks when the robot goes below the height it started at.
    teacher: the key of the teacher's link, where the page is for a class.
    replay: makes the format of a shared replay, of notes and the name of the source, where there is one.
    for_viewers: controls, by their uuids, that change nothing for anybody else: who only looks may use them too.
    failures: title of a view or panel that raised and was switched off -> reason.
    """

    server: viser.ViserServer
    send: Callable[[Command], None]
    display: Display = field(default_factory=Display)
    layers: list[Layer] = field(default_factory=list)
    failures: dict[str, str] = field(default_factory=dict)
    teacher: str | None = None
    for_viewers: set[str] = field(default_factory=set)
    replay: "Callable[[Sequence[Note], str], Exporter] | None" = None
    floor: viser.FrameHandle = field(init=False)
    _lock: threading.RLock = field(default_factory=threading.RLock)

    def __post_init__(self) -> None:
        self.floor = self.server.scene.add_frame("/floor", show_axes=False)
        self.server.gui.configure_theme(
            dark_mode=SENT.dark, brand_color=SENT.accent, show_logo=False, show_share_button=False
        )

    def layer(self, key: str, title: str, *, on_floor: bool = False, **more: Any) -> Layer:
        """A new layer; `title` is the label of its switch. on_floor: it lies on the plane of the finest level.

        more: other fields of Layer.
        """
        name = f"{self.floor.name if on_floor else ''}/{key}"
        layer = Layer(key, title, self.server.scene.add_frame(name, show_axes=False), **more)
        self.layers.append(layer)
        return layer

    def show(self, **changes: Any) -> None:
        """Change display settings by name (fields of Display); values out of range are clamped. Any thread."""
        known = {f.name for f in fields(Display)}
        if unknown := changes.keys() - known:
            raise KeyError(f"Display has no {sorted(unknown)}: choose from {sorted(known)}")
        with self._lock:
            self.display = replace(self.display, **changes)

    def ask(self, layer: Layer) -> None:
        """Send a layer on demand from now on: a browser has switched it on."""
        with self._lock:
            self.show(asked=self.display.asked | {layer.key})

    def camera(self, mode: Camera, client: viser.ClientHandle | None = None) -> None:
        """Point one browser's camera (every browser's when None): each person keeps a view of their own."""
        if mode in get_args(Camera):
            self.run(f"window.hectorscope?.camera('{mode}')", client)

    def notify(self, sentence: str, client: viser.ClientHandle | None = None, *, failed: bool = False) -> None:
        """Show a sentence in a corner of one page, or of every open one, for some seconds; in red what failed."""
        for target in [client] if client is not None else list(self.server.get_clients().values()):
            target.add_notification("", sentence, auto_close_seconds=NOTICE_S, color="red" if failed else None)

    def run(self, script: str, client: viser.ClientHandle | None = None) -> None:
        """Run JavaScript once in one browser, or in all that are connected now; late joiners never see it.

        Scripts that every page needs belong to static/, which the page loads by itself.
        """
        for target in [client] if client is not None else list(self.server.get_clients().values()):
            viser_private.run_script(target, script)

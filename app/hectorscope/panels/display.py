"""How things are shown: layout of the levels, layers and camera of each browser, and what all browsers share."""

import math
from collections.abc import Callable
from typing import Any, cast

from viser import GuiEvent, Icon

from hectorscope.page import marks, viser_private
from hectorscope.page.ellipse_scale import fitted
from hectorscope.page.scene import ELLIPSE_SCALE_RANGE, Camera, Layer, Scene
from hectorscope.panels import _own, _workspace
from hectorscope.panels._controls import Choice, Control, LogSlider, Switch
from hectorscope.panels._handles import put
from hectorscope.panels._slider import Scale
from hectorscope.session.snapshot import Snapshot

CAMERAS: dict[str, Camera] = {"Top": "top", "Follow": "follow", "Free": "free", "Whole map": "fit"}
LAYOUTS = {"stacked": "levels stacked", "side": "levels side by side", "one": "one level"}
POINTS = {"residual": "by residual", "height": "by height", "plain": "plain"}
GAP = (0.05, 2.0, 0.05)
SIGMAS = Scale(
    math.log10(ELLIPSE_SCALE_RANGE[0]), math.log10(ELLIPSE_SCALE_RANGE[1]), 0.01, log=True, integer=False
)


class DisplayPanel:
    """Each browser's own controls, and those of Scene.display, which all browsers share."""

    title = "Display"
    order = 60
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._drawn = scene.display
        self._resolutions: tuple[float, ...] = ()
        gui = scene.server.gui
        self._levels = gui.add_html(marks.levels_mark(()))
        gui.add_html(marks.layers_mark([(layer, self._ask(layer)) for layer in scene.layers]))
        with _workspace.tab(scene, self.title, Icon.EYE):
            _workspace.mark(scene, "display")
            self._own = gui.add_html(own_html(()))
            boxes = (_own.layer_box(layer.key, layer.title, layer.colour) for layer in scene.layers)
            names = _own.layer_box("names", "Level names")
            gui.add_html(f'<div class="hs-own hs-layers">{"".join(boxes)}{names}</div>')
            gui.add_html(_own.SHARED)
            self._controls = self._add_controls()
        for key, name in enumerate(CAMERAS, start=1):
            self._add_hotkey(str(key), name)

    def _ask(self, layer: Layer) -> str:
        """The hidden button by which a browser asks for a layer on demand."""
        if not layer.on_demand:
            return ""
        button = self._scene.server.gui.add_button(f"Send {layer.title.lower()}", visible=False)
        button.on_click(lambda _: self._scene.ask(layer))
        return viser_private.uuid_of(button)

    def _add_controls(self) -> dict[str, Control]:
        gui, now = self._scene.server.gui, self._scene.display
        scale = LogSlider(
            gui,
            "Ellipses (σ)",
            SIGMAS,
            now.ellipse_scale,
            "Ellipses are drawn this many sigmas large. Moving this holds it.",
            lambda _: self._scene.show(ellipse_scale=self._controls["ellipse_scale"].read(), ellipse_fit=False),
        )
        fit = Switch(
            gui,
            "Fit the ellipses",
            now.ellipse_fit,
            "Chooses the number of sigmas so that the ellipses are well seen in the map.",
            self._setter("ellipse_fit"),
        )
        points = Choice(
            gui, "Scan", POINTS, now.points, "What colours the scan's endpoints.", self._setter("points")
        )
        return {"ellipse_scale": scale, "ellipse_fit": fit, "points": points}

    def _setter(self, name: str) -> Callable[[GuiEvent[Any]], None]:
        return lambda _: self._scene.show(**{name: self._controls[name].read()})

    def _add_hotkey(self, key: str, name: str) -> None:
        title = f"Camera: {name.lower()}"
        command = self._scene.server.gui.add_command(title, hotkey=cast(Any, key), icon=Icon.CAMERA)
        command.on_trigger(lambda event: self._scene.camera(CAMERAS[name], event.client))

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the display settings, whoever changed them, and the number of levels."""
        resolutions = tuple(image.resolution for image in snapshot.maps)
        if resolutions and resolutions != self._resolutions:
            self._resolutions = resolutions
            put(self._levels, marks.levels_mark(resolutions))
            put(self._own, own_html(resolutions))
        self._fit_ellipses(snapshot)
        display, before = self._scene.display, self._drawn
        if display == before:
            return
        self._drawn = display
        for name, control in self._controls.items():  # what did not change may be under somebody's hand
            if getattr(display, name) != getattr(before, name):
                control.show(getattr(display, name))

    def _fit_ellipses(self, snapshot: Snapshot) -> None:
        now = self._scene.display
        if now.ellipse_fit and (scale := fitted(snapshot, now.ellipse_scale)) != now.ellipse_scale:
            self._scene.show(ellipse_scale=scale)


def own_html(resolutions: tuple[float, ...]) -> str:
    """Camera, layout of the levels and the picture: this browser's own."""
    levels = {str(i): f"{i}: {level_name(r)}" for i, r in enumerate(resolutions)} or {"0": "finest"}
    cameras = "".join(
        f'<button type="button" data-hs-camera="{mode}">{name}</button>' for name, mode in CAMERAS.items()
    )
    return (
        f'{_own.OWN}<div class="hs-own">'
        '<div class="hs-own-row" title="Keys 1 to 4."><span>Camera</span>'
        f'<div class="hs-group">{cameras}</div></div>'
        + _own.choice("layout", "Map", LAYOUTS, "How the levels of the pyramid are laid out.")
        + _own.slider("gap", "Gap", GAP, "Between stacked levels: times the depth of the map.")
        + _own.choice("level", "Level", levels, "The one level shown.")
        + '<button type="button" class="hs-wide" data-hs-do="measure"'
        ' title="Between two places that are clicked. Key D.">Measure a distance</button></div>'
    )


def level_name(resolution: float) -> str:
    """A level by the length of its cells."""
    return f"{100 * resolution:g} cm cells"


PANEL = DisplayPanel

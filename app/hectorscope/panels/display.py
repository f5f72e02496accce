"""How things are shown: layout of the levels, layers, the size of the ellipses, the camera."""

import math
from collections.abc import Callable
from typing import Any, cast

from viser import GuiButtonGroupHandle, GuiButtonHandle, GuiEvent, Icon

from hectorscope.page.scene import ELLIPSE_SCALE_RANGE, GAP_RANGE, Camera, Layer, Scene
from hectorscope.panels import _workspace
from hectorscope.panels._controls import Choice, Control, LinearSlider, LogSlider, Switch
from hectorscope.panels._ellipse_scale import fitted
from hectorscope.panels._slider import Scale
from hectorscope.run.map_images import MapImage
from hectorscope.session.snapshot import Snapshot

CAMERAS: dict[str, Camera] = {"Top": "top", "Follow": "follow", "Free": "free", "Whole map": "fit"}
LAYOUTS = {"stacked": "levels stacked", "side": "levels side by side", "one": "one level"}
POINTS = {"residual": "by residual", "height": "by height", "plain": "plain"}
GAP = Scale(GAP_RANGE[0], GAP_RANGE[1], 0.05, log=False, integer=False)
PICTURE = "window.hectorscope?.picture()"
SIGMAS = Scale(
    math.log10(ELLIPSE_SCALE_RANGE[0]), math.log10(ELLIPSE_SCALE_RANGE[1]), 0.01, log=True, integer=False
)


class DisplayPanel:
    """Controls of Scene.display, which all browsers share; the camera belongs to each browser alone."""

    title = "Display"
    order = 60
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._drawn = scene.display
        self._resolutions: tuple[float, ...] = ()
        gui = scene.server.gui
        with _workspace.tab(scene, self.title, Icon.EYE):
            _workspace.mark(scene, "display")
            camera = gui.add_button_group(
                "Camera", tuple(CAMERAS), hint="Moves this browser's camera alone. Keys 1 to 4."
            )
            self._controls = self._add_controls()
            self._level = gui.add_dropdown(
                "Level", ("finest",), initial_value="finest", hint="The one level shown."
            )
            picture = gui.add_button(
                "Save a picture", icon=Icon.CAMERA, hint="The scene as this browser shows it, as a PNG file."
            )
            with gui.add_folder("Layers"):
                self._layers = {layer.key: self._add_layer(layer) for layer in scene.layers}
        camera.on_click(self._point_camera)
        picture.on_click(self._save_picture)
        for key, name in enumerate(CAMERAS, start=1):
            self._add_hotkey(str(key), name)
        self._level.on_update(self._choose_level)

    def _add_controls(self) -> dict[str, Control]:
        gui, now = self._scene.server.gui, self._scene.display
        layout = Choice(
            gui, "Map", LAYOUTS, now.layout, "How the levels of the pyramid are laid out.", self._setter("layout")
        )
        gap = LinearSlider(gui, "Gap", GAP, now.gap, "Times the depth of the map.", self._setter("gap"))
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
        return {"layout": layout, "gap": gap, "ellipse_scale": scale, "ellipse_fit": fit, "points": points}

    def _setter(self, name: str) -> Callable[[GuiEvent[Any]], None]:
        return lambda _: self._scene.show(**{name: self._controls[name].read()})

    def _add_layer(self, layer: Layer) -> Control:
        shown = layer.key not in self._scene.display.hidden
        if layer.colour:
            _workspace.mark(self._scene, f"swatch hs-{layer.colour}")
        box = Switch(
            self._scene.server.gui,
            layer.title,
            shown,
            None,
            lambda e: self._scene.show_layer(layer.key, e.target.value),
        )
        return cast(Control, box)

    def _add_hotkey(self, key: str, name: str) -> None:
        title = f"Camera: {name.lower()}"
        command = self._scene.server.gui.add_command(title, hotkey=cast(Any, key), icon=Icon.CAMERA)
        command.on_trigger(lambda event: self._scene.camera(CAMERAS[name], event.client))

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the display settings, whoever changed them, and the number of levels."""
        self._draw_levels(snapshot.maps)
        self._fit_ellipses(snapshot)
        display, before = self._scene.display, self._drawn
        if display == before:
            return
        self._drawn = display
        for name, control in self._controls.items():  # what did not change may be under somebody's hand
            if getattr(display, name) != getattr(before, name):
                control.show(getattr(display, name))
        for key, box in self._layers.items():
            if (key in display.hidden) != (key in before.hidden):
                box.show(key not in display.hidden)

    def _fit_ellipses(self, snapshot: Snapshot) -> None:
        now = self._scene.display
        if now.ellipse_fit and (scale := fitted(snapshot, now.ellipse_scale)) != now.ellipse_scale:
            self._scene.show(ellipse_scale=scale)

    def _draw_levels(self, maps: tuple[MapImage, ...]) -> None:
        resolutions = tuple(image.resolution for image in maps)
        if resolutions and resolutions != self._resolutions:
            self._resolutions = resolutions
            self._level.options = [level_name(r) for r in resolutions]
        only = self._scene.display.layout == "one"
        if self._level.visible != only:
            self._level.visible = only

    def _choose_level(self, event: GuiEvent[Any]) -> None:
        names = [level_name(r) for r in self._resolutions]
        if event.client is not None and event.target.value in names:
            self._scene.show(level=names.index(event.target.value))

    def _point_camera(self, event: GuiEvent[GuiButtonGroupHandle]) -> None:
        if event.target.value in CAMERAS:
            self._scene.camera(CAMERAS[event.target.value], event.client)

    def _save_picture(self, event: GuiEvent[GuiButtonHandle]) -> None:
        if event.client is not None:  # else every browser would save one
            self._scene.run(PICTURE, event.client)


def level_name(resolution: float) -> str:
    """A level by the length of its cells."""
    return f"{100 * resolution:g} cm cells"


PANEL = DisplayPanel

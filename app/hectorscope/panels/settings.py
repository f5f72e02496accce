"""The configuration tree as controls: what is moved here acts on the run that every browser shows."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from itertools import groupby
from time import monotonic
from typing import Any

from viser import GuiApi, GuiEvent, Icon

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._controls import Choice, control_for
from hectorscope.panels._format import label
from hectorscope.session.commands import Configure, ConfigureAll
from hectorscope.session.snapshot import Snapshot
from slam_core.config import PRESETS, ConfigError, Leaf, SlamConfig, leaves, preset_of

TITLES = {
    "scan": "Scan · section IV",
    "map": "Map · IV-A, IV-C",
    "matcher": "Matcher · IV-B",
    "navigation": "Filter · V-A",
    "motion": "Motion · without inertial data",
    "fusion": "Fusion · V-B",
}
RESTART_SETTLE = 0.6  # seconds at rest before the map is rebuilt: one rebuild a drag, not one a pixel
PATIENCE = 2.0  # seconds that a control waits for the run to take its value over


CUSTOM = "custom"
EXTENTS = {"here": "from here on", "run": "for the whole run"}
EXTENT_HINT = (
    "From here on: the scan that is shown is processed again, and what was before it stays."
    " For the whole run: the recording runs again up to here."
)
PRESET_HINT = "The defaults, or the paper's method without their additions. Custom: neither of them."


class SettingsPanel:
    """The preset, and a folder for each group of the tree with a control for each leaf and a reset."""

    title = "Settings"
    order = 50
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._groups: list[Group] = []
        with _workspace.tab(scene, self.title, Icon.ADJUSTMENTS_HORIZONTAL):
            _workspace.mark(scene, "settings")
            self._preset = PresetChoice(scene.server.gui, self._send)
            self._extent = Choice(scene.server.gui, "Changes act", EXTENTS, "here", EXTENT_HINT, lambda _: None)
            for name, members in groupby(leaves(SlamConfig()), key=lambda leaf: leaf.name.split(".")[0]):
                self._groups.append(Group(scene.server.gui, self._send, name, list(members)))

    def draw(self, snapshot: Snapshot) -> None:
        """Send what was touched, show what the run uses."""
        if snapshot.sequence == 0:
            return  # no run yet: nothing to go back to either
        self._preset.draw(snapshot.config, monotonic())
        live = snapshot.playback.live
        self._extent.visible = not live  # a stream cannot be run again
        values = {leaf.name: leaf.value for leaf in leaves(snapshot.config)}
        for group in self._groups:
            group.draw(values, live, settle=self._throughout)

    @property
    def _throughout(self) -> bool:
        return self._extent.read() == "run"

    def _send(self, command: Configure | ConfigureAll) -> None:
        self._scene.send(replace(command, throughout=self._throughout))


class PresetChoice:
    """Shows which preset the run has, and sets all settings of another one at once."""

    def __init__(self, gui: GuiApi, send: Callable[[ConfigureAll], None]) -> None:
        self._send = send
        names = {name: name for name in (*PRESETS, CUSTOM)}
        self._control = Choice(gui, "Preset", names, "default", PRESET_HINT, self._note)
        self._touched = False
        self._shown = "default"
        self._asked: tuple[str, float] | None = None

    def _note(self, _: GuiEvent[Any]) -> None:
        self._touched = True

    def draw(self, config: SlamConfig, now: float) -> None:
        """now: seconds of a clock that only runs forward."""
        used = preset_of(config) or CUSTOM
        if self._touched:
            self._touched, wanted = False, self._control.read()
            self._shown = wanted
            for values in (values for name, values in PRESETS.items() if name == wanted != used):
                self._asked = wanted, now
                self._send(ConfigureAll(f"preset {wanted}", values))
        if self._asked is not None and used != self._asked[0] and now - self._asked[1] < PATIENCE:
            return
        if used != self._shown:  # else a choice could be lost before its callback
            self._control.show(used)
        self._asked, self._shown = None, used


class Group:
    """The settings of one part of the pipeline: the basic ones, and the others in a folded folder."""

    def __init__(self, gui: GuiApi, send: Callable[[Configure], None], name: str, members: list[Leaf]) -> None:
        self._first: dict[str, Any] = {}
        self._values: dict[str, Any] = {}
        self._send = send
        basic = [leaf for leaf in members if leaf.param.tier == "basic"]
        expert = [leaf for leaf in members if leaf.param.tier == "expert"]
        with gui.add_folder(TITLES.get(name, name.capitalize()), expand_by_default=bool(basic)):
            self._settings = [Setting(gui, leaf, send) for leaf in basic]
            with gui.add_folder(f"Expert · {len(expert)}", expand_by_default=False) if basic else nullcontext():
                self._settings += [Setting(gui, leaf, send) for leaf in expert]
            self._reset = gui.add_button("Reset", icon=Icon.RESTORE, disabled=True)
        self._reset.on_click(lambda _: self._reset_all())

    def draw(self, values: dict[str, Any], live: bool, *, settle: bool = False) -> None:
        """Bring controls and the reset button up to date. settle: as for a `Setting`."""
        self._first = self._first or values
        self._values = values
        for setting in self._settings:
            setting.draw(values[setting.name], live, monotonic(), settle=settle)
        changed = sum(values[s.name] != self._first[s.name] for s in self._settings)
        label = f"Reset {changed} changed" if changed else "Nothing changed"
        if self._reset.label != label:
            self._reset.label, self._reset.disabled = label, changed == 0

    def _reset_all(self) -> None:
        for setting in self._settings:
            if self._values[setting.name] != self._first[setting.name]:
                self._send(Configure(setting.name, self._first[setting.name]))


class Setting:
    """One control. Touched, it speaks; else it shows what the run uses."""

    def __init__(self, gui: GuiApi, leaf: Leaf, send: Callable[[Configure], None]) -> None:
        self.name = leaf.name
        self._gui, self._leaf, self._send = gui, leaf, send
        if leaf.param.restart:
            gui.add_html('<i class="hs-mark hs-restart"></i>')
        self._control = control_for(gui, leaf, self._note)
        self._shown = leaf.value
        self._touched: float | None = None
        self._asked: tuple[Any, float] | None = None

    def _note(self, _: GuiEvent[Any]) -> None:
        self._touched = monotonic()

    def draw(self, value: Any, live: bool, now: float, *, settle: bool = False) -> None:
        """value: what the run uses. now: seconds, monotonic. settle: any change runs the recording again."""
        if self._touched is not None:
            if (settle or self._leaf.param.restart) and now - self._touched < RESTART_SETTLE:
                return
            self._touched = None
            self._ask(value, live, now)
        if self._asked is not None:
            wanted, since = self._asked
            if value != wanted and now - since < PATIENCE:
                return
            self._asked, self._shown = None, None
        if value != self._shown:
            self._control.show(value)
            self._shown = value

    def _ask(self, value: Any, live: bool, now: float) -> None:
        try:
            wanted = self._leaf.check(self._control.read())
        except ConfigError:
            wanted = value  # a browser may send anything; the control falls back to what the run uses
        self._asked = wanted, now
        if wanted == value:
            return
        if live and self._leaf.param.restart:
            self._confirm(wanted)
        else:
            self._send(Configure(self.name, wanted))

    def _confirm(self, wanted: Any) -> None:
        """Ask first, on every page: the map belongs to everybody, and a stream cannot bring it back."""
        modal = self._gui.add_modal("Begin a new map?")
        with modal:
            self._gui.add_markdown(
                f"**{label(self._leaf)}: {wanted}** needs a new map. The present one would be lost."
            )
            apply, keep = self._gui.add_button("Begin a new map"), self._gui.add_button("Keep the map")
        for button in (apply, keep):
            button.on_click(lambda _: modal.close())
        apply.on_click(lambda _: self._send(Configure(self.name, wanted)))


PANEL = SettingsPanel

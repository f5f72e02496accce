"""The configuration tree as controls: what is moved here acts on the run that every browser shows."""

from collections.abc import Callable
from dataclasses import replace
from itertools import groupby
from time import monotonic
from typing import Any

from viser import GuiApi, GuiEvent, Icon

from hectorscope.page import viser_private
from hectorscope.page.scene import Scene
from hectorscope.panels import _own, _workspace
from hectorscope.panels._controls import Choice, by_hand, control_for
from hectorscope.panels._format import label, text, title, worded
from hectorscope.panels._handles import put, put_value
from hectorscope.session.commands import Configure, ConfigureAll
from hectorscope.session.snapshot import Snapshot
from slam_core.config import (
    PRESETS,
    ConfigError,
    Leaf,
    Leaves,
    Preset,
    SlamConfig,
    differences,
    nearest_preset,
    preset,
)

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

EXTENTS = {"here": "from here on", "run": "for the whole run"}
EXTENT_HINT = (
    "From here on: the scan that is shown is processed again, and what was before it stays."
    " For the whole run: the recording runs again up to here."
)
PRESET_HINT = "The defaults, or the paper's method without their additions."


class SettingsPanel:
    """What differs from the preset, the settings that are needed first, and a folder for each group of the tree.

    Each browser finds and shows settings of other tiers by itself (static/settings.js).
    """

    title = "Settings"
    order = 50
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._gui = scene.server.gui
        self._start: SlamConfig | None = None
        self._config: SlamConfig | None = None
        self._values = known = Leaves(SlamConfig())
        self._nearest: Preset = "default"
        self._resets: dict[str, Configure | ConfigureAll] = {}
        first = [leaf for leaf in known.values() if leaf.param.tier == "first"]
        rest = [leaf for leaf in known.values() if leaf.param.tier != "first"]
        with _workspace.tab(scene, self.title, Icon.ADJUSTMENTS_HORIZONTAL):
            _workspace.mark(scene, "settings")
            self._add_head(len(known))
            self._preset = PresetChoice(self._gui, self._send)
            self._settings = [Setting(self._gui, leaf, self._send) for leaf in first]
            self._extent = Choice(self._gui, "Changes act", EXTENTS, "here", EXTENT_HINT, lambda _: None)
            for name, members in groupby(rest, key=lambda leaf: leaf.name.split(".")[0]):
                with self._gui.add_folder(TITLES.get(name, name.capitalize())):
                    self._settings += [Setting(self._gui, leaf, self._send) for leaf in members]

    def _add_head(self, count: int) -> None:
        """The search, what differs from the preset, and what hears the buttons that reset it."""
        self._gui.add_html(_own.SHARED + SEARCH.format(count=count))
        self._banner = self._gui.add_html(UNCHANGED)
        reset = self._gui.add_text("Reset", "", visible=False)
        self._gui.add_html(f'<i class="hs-mark" data-hs-resets="{viser_private.uuid_of(reset)}"></i>')
        reset.on_update(by_hand(self._reset))

    def draw(self, snapshot: Snapshot) -> None:
        """Send what was touched, show what the run uses."""
        if snapshot.sequence == 0:
            return  # no run yet: nothing to go back to either
        self._extent.visible = not snapshot.playback.live  # a stream cannot be run again
        if snapshot.config is not self._config:
            self._config, self._values = snapshot.config, Leaves(snapshot.config)
            self._start = self._start or snapshot.config
            self._draw_differences(snapshot.config, self._start)
        now = monotonic()
        self._preset.draw(self._nearest, now)
        for setting in self._settings:
            setting.draw(self._values[setting.name].value, now, settle=self._throughout)

    def _draw_differences(self, config: SlamConfig, start: SlamConfig) -> None:
        self._nearest, was = nearest_preset(config)
        known = self._values
        own = start not in (config, *map(preset, PRESETS))  # else it says the same as a preset
        self._resets = {
            **{name: Configure(name, value) for name, value in was.items()},
            ALL: ConfigureAll(f"reset to {self._nearest}", was),
            **({START: ConfigureAll("reset to the start", differences(config, start))} if own else {}),
        }
        put(self._banner, banner(self._nearest, [(known[name], value) for name, value in was.items()], own))
        for setting in self._settings:
            setting.mark(was.get(setting.name))

    @property
    def _throughout(self) -> bool:
        return self._extent.read() == "run"

    def _reset(self, event: GuiEvent[Any]) -> None:
        """A button in the page says what to reset: one setting, all of them, or to the start."""
        wanted = event.target.value
        put_value(event.target, "")  # so that the same can be asked for again
        if command := self._resets.get(wanted):
            self._send(command)

    def _send(self, command: Configure | ConfigureAll) -> None:
        self._scene.send(replace(command, throughout=self._throughout))


ALL, START = "all", "start"
SEARCH = (
    '<div class="hs-find">'
    '<input type="search" placeholder="Find one of {count} settings" aria-label="Find a setting">'
    '<label><input type="checkbox"> expert</label><output></output></div>'
)
UNCHANGED = '<i class="hs-mark"></i>'


def banner(name: Preset, differing: list[tuple[Leaf, Any]], own: bool) -> str:
    """What differs from a preset, as HTML: settings with their values and those of the preset.

    own: whether the settings at the start are those of no preset, and other ones now.
    """
    entries = "".join(
        f"<li>{reset_button(leaf.name, '↺', tip(leaf.name, was))}"
        f"<b>{text(title(leaf))}</b> {text(worded(leaf.value))} <small>({text(worded(was))})</small></li>"
        for leaf, was in differing
    )
    buttons = reset_button(ALL, "Reset all", f"Reset all to the preset {name}") if differing else ""
    if own:
        buttons += reset_button(START, "As started", "As started: every setting as flags and file had it")
    if not buttons:
        return UNCHANGED
    words = f"Differs from <b>{name}</b> in {len(differing)}" if differing else f"All as in <b>{name}</b>"
    head = f"<p><span>{words}</span>{buttons}</p>"
    return f'<div class="hs-differs">{head}<ul>{entries}</ul></div>'


def reset_button(what: str, words: str, hint: str) -> str:
    """A button of static/settings.js."""
    kind = f'type="button" class="hs-reset" data-hs-reset="{what}"'
    return f'<button {kind} title="{text(hint)}" aria-label="{text(hint)}">{words}</button>'


def tip(name: str, was: Any) -> str:
    """What a button beside a setting does."""
    return f"Reset {name} to {worded(was)}, as in the preset"


class PresetChoice:
    """Shows which preset the run is nearest to, and sets all settings of another one at once."""

    def __init__(self, gui: GuiApi, send: Callable[[ConfigureAll], None]) -> None:
        self._send = send
        self._control = Choice(gui, "Preset", {name: name for name in PRESETS}, "default", PRESET_HINT, self._note)
        self._touched = False
        self._shown = "default"
        self._asked: tuple[str, float] | None = None

    def _note(self, _: GuiEvent[Any]) -> None:
        self._touched = True

    def draw(self, used: Preset, now: float) -> None:
        """used: the preset of the run. now: seconds of a clock that only runs forward."""
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


class Setting:
    """One control. Touched, it speaks; else it shows what the run uses. A mark: the preset has another."""

    def __init__(self, gui: GuiApi, leaf: Leaf, send: Callable[[Configure], None]) -> None:
        self.name = leaf.name
        self._leaf, self._send = leaf, send
        self._mark = gui.add_html("")
        self.mark(None)
        self._control = control_for(gui, leaf, self._note)
        self._shown = leaf.value
        self._touched: float | None = None
        self._asked: tuple[Any, float] | None = None

    def mark(self, was: Any) -> None:
        """was: the value of the preset, if that is another one; None takes the mark away.

        The element in front of the control has what the search and the style sheet go by, and the button.
        """
        param = self._leaf.param
        words = text(f"{self.name} {label(self._leaf)} {param.help}")
        kinds = "hs-setting" + " hs-restart" * param.restart + " hs-changed" * (was is not None)
        button = "" if was is None else reset_button(self.name, "↺", tip(self.name, was))
        put(self._mark, f'<i class="{kinds}" data-hs-tier="{param.tier}" data-hs-words="{words}">{button}</i>')

    def _note(self, _: GuiEvent[Any]) -> None:
        self._touched = monotonic()

    def draw(self, value: Any, now: float, *, settle: bool = False) -> None:
        """value: what the run uses. now: seconds, monotonic. settle: any change runs the recording again."""
        if self._touched is not None:
            if (settle or self._leaf.param.restart) and now - self._touched < RESTART_SETTLE:
                return
            self._touched = None
            self._ask(value, now)
        if self._asked is not None:
            wanted, since = self._asked
            if value != wanted and now - since < PATIENCE:
                return
            self._asked, self._shown = None, None
        if value != self._shown:
            self._control.show(value)
            self._shown = value

    def _ask(self, value: Any, now: float) -> None:
        try:
            wanted = self._leaf.check(self._control.read())
        except ConfigError:
            wanted = value  # a browser may send anything; the control falls back to what the run uses
        self._asked = wanted, now
        if wanted != value:
            self._send(Configure(self.name, wanted))


PANEL = SettingsPanel

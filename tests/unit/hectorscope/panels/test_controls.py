"""Controls between a person's hand and what the run really does; the clock is the test's."""

import re
from typing import Any

import pytest

from hectorscope.page.scene import Scene
from hectorscope.panels._format import label
from hectorscope.panels.display import DisplayPanel
from hectorscope.panels.settings import PATIENCE, RESTART_SETTLE, PresetChoice, Setting, SettingsPanel
from hectorscope.panels.transport import TransportPanel
from hectorscope.session.commands import Command, Configure, ConfigureAll
from hectorscope.session.snapshot import PlaybackStatus, Snapshot
from slam_core.config import PRESETS, SlamConfig, differences, leaves, with_values
from tests.hands import by_hand

S = 1_000_000_000
LEAVES = {leaf.name: leaf for leaf in leaves(SlamConfig())}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The panels' clock, to be set by the test."""
    now = [100.0]
    monkeypatch.setattr("hectorscope.panels.settings.monotonic", lambda: now[0])
    monkeypatch.setattr("hectorscope.panels.transport.monotonic", lambda: now[0])
    return now


def setting(scene: Scene, name: str) -> tuple[Setting, list[Configure]]:
    sent: list[Configure] = []
    return Setting(scene.server.gui, LEAVES[name], sent.append), sent


def test_a_moved_slider_is_sent_once_and_kept_until_the_run_follows(scene: Scene, clock: list[float]) -> None:
    """The control does not jump back while the run still uses the old value."""
    omega, sent = setting(scene, "fusion.omega")
    by_hand(omega._control._slider, 0.5)
    omega.draw(0.1, 100.0)
    omega.draw(0.1, 100.5)
    assert sent == [Configure("fusion.omega", 0.5)]
    assert omega._control.read() == 0.5
    omega.draw(0.5, 100.6)
    omega.draw(0.7, 100.7)
    assert omega._control.read() == 0.7


def test_a_second_click_counts_while_the_panel_draws_the_first(scene: Scene, clock: list[float]) -> None:
    """A browser is heard at once: what is drawn just then does not put the switch back."""
    stabilise, sent = setting(scene, "scan.stabilise")
    by_hand(stabilise._control._box, False)
    stabilise.draw(True, 100.0)
    by_hand(stabilise._control._box, True)
    stabilise.draw(False, 100.1)
    assert sent == [Configure("scan.stabilise", False), Configure("scan.stabilise", True)]
    assert stabilise._control.read() is True


def test_a_value_that_the_run_refuses_falls_back(scene: Scene, clock: list[float]) -> None:
    """After some patience the control shows again what the run uses."""
    omega, _ = setting(scene, "fusion.omega")
    by_hand(omega._control._slider, 0.5)
    omega.draw(0.1, 100.0)
    omega.draw(0.1, 100.0 + PATIENCE + 0.1)
    assert omega._control.read() == 0.1


def test_a_setting_that_rebuilds_the_map_waits_for_the_hand_to_rest(scene: Scene, clock: list[float]) -> None:
    """A drag over a restart setting is one command, with its last value."""
    levels, sent = setting(scene, "map.levels")
    for step, value in enumerate((2, 4, 5)):
        clock[0] = 100.0 + 0.2 * step
        by_hand(levels._control._slider, value)
        levels.draw(3, clock[0])
    levels.draw(3, clock[0] + RESTART_SETTLE + 0.01)
    assert sent == [Configure("map.levels", 5)]


def test_a_control_moved_by_the_server_sends_nothing(scene: Scene, clock: list[float]) -> None:
    """Following another browser or the command line is no command."""
    sigma, sent = setting(scene, "matcher.sigma")
    sigma.draw(0.5, 100.0)
    sigma.draw(0.5, 101.0)
    assert sent == []
    assert sigma._control.read() == pytest.approx(0.5, rel=5e-3)


def test_slider_and_box_of_a_logarithmic_setting_follow_each_other(scene: Scene, clock: list[float]) -> None:
    """A typed value moves the slider, a moved slider fills the box."""
    sigma, sent = setting(scene, "matcher.sigma")
    by_hand(sigma._control._number, 1.0)
    sigma.draw(0.2, 100.0)
    sigma.draw(1.0, 100.1)
    assert sigma._control._slider.value == pytest.approx(0.0)
    by_hand(sigma._control._slider, 1.0)
    sigma.draw(1.0, 100.2)
    sigma.draw(10.0, 100.3)
    assert sigma._control._number.value == 10.0
    assert sent == [Configure("matcher.sigma", 1.0), Configure("matcher.sigma", 10.0)]


def test_a_preset_is_one_command_with_all_its_settings(scene: Scene, clock: list[float]) -> None:
    """The choice stays until the run follows, and then shows what the run is nearest to."""
    sent: list[ConfigureAll] = []
    choice = PresetChoice(scene.server.gui, sent.append)
    by_hand(choice._control._list, "paper")
    choice.draw("default", 100.0)
    choice.draw("default", 100.5)
    assert sent == [ConfigureAll("preset paper", PRESETS["paper"])]
    assert choice._control.read() == "paper"
    choice.draw("default", 100.0 + PATIENCE + 0.6)
    assert choice._control.read() == "default"


CHANGED = with_values(SlamConfig(), {"fusion.omega": 0.7, "navigation.gravity": 9.7})


def settings_panel(scene: Scene, *configs: SlamConfig, live: bool = False) -> tuple[SettingsPanel, list[Command]]:
    """The panel of a run that had these configurations, and what it sends."""
    sent: list[Command] = []
    scene.send = sent.append
    panel = SettingsPanel(scene)
    for sequence, config in enumerate(configs, start=1):
        panel.draw(Snapshot(sequence=sequence, config=config, playback=PlaybackStatus(live=live)))
    return panel, sent


def resets(panel: SettingsPanel) -> Any:
    """The control that hears the buttons which reset something."""
    return next(h for h in panel._gui._gui_input_handle_from_uuid.values() if getattr(h, "label", "") == "Reset")


def test_settings_that_differ_from_the_preset_are_named_and_marked(scene: Scene) -> None:
    """With their values and those of the preset; nothing where nothing differs."""
    panel, _ = settings_panel(scene, SlamConfig(), CHANGED)
    text = re.sub("<[^>]*>", "", panel._banner.content)
    assert "Differs from default in 2" in text
    assert "Weight of the match, ω 0.7 (0.02)" in text
    assert "Gravity 9.7 (9.80665)" in text
    marked = [setting.name for setting in panel._settings if "hs-changed" in setting._mark.content]
    assert marked == ["fusion.omega", "navigation.gravity"]
    panel.draw(Snapshot(sequence=3, config=SlamConfig.paper()))
    assert "paper" not in panel._banner.content


def test_one_setting_or_all_of_them_are_reset(scene: Scene) -> None:
    """To the values of the preset; a name that stands for nothing sends nothing, whatever a browser says."""
    panel, sent = settings_panel(scene, SlamConfig(), CHANGED)
    for name in ("fusion.omega", "fusion.omega", "scan.deskew", "nothing", "all", "start"):
        by_hand(resets(panel), name)
    one, every = Configure("fusion.omega", 0.02), {"fusion.omega": 0.02, "navigation.gravity": 9.80665}
    assert sent == [one, one, ConfigureAll("reset to default", every)]


def test_the_settings_of_the_start_can_be_had_again(scene: Scene) -> None:
    """Flags and file may have made them others than those of any preset."""
    panel, sent = settings_panel(scene, CHANGED, SlamConfig.paper())
    assert "As started" in panel._banner.content
    by_hand(resets(panel), "start")
    assert sent == [ConfigureAll("reset to the start", differences(SlamConfig.paper(), CHANGED))]
    panel.draw(Snapshot(sequence=9, config=CHANGED))
    assert "As started" not in panel._banner.content


def test_names_of_settings_tell_them_apart() -> None:
    """No two settings have the same name on the page."""
    names = [label(leaf) for leaf in LEAVES.values()]
    assert {name for name in names if names.count(name) > 1} == set()


def test_a_speed_that_was_just_chosen_stays(scene: Scene) -> None:
    """Until the run knows of it: a picture drawn in between does not put the old one back."""
    panel = TransportPanel(scene)
    panel.draw(Snapshot(playback=PlaybackStatus(speed=1.0)))
    panel._speed._impl.value = "max"  # as viser has it before it calls anybody
    panel.draw(Snapshot(playback=PlaybackStatus(speed=1.0)))
    assert panel._speed.value == "max"
    panel.draw(Snapshot(playback=PlaybackStatus(speed=2.0)))
    assert panel._speed.value == "2×"


def test_a_display_setting_that_was_just_chosen_stays(scene: Scene) -> None:
    """While another one changes."""
    panel = DisplayPanel(scene)
    points = panel._controls["points"]
    points._list._impl.value = "by height"  # type: ignore[attr-defined]
    scene.show(ellipse_fit=False)
    panel.draw(Snapshot())
    assert points.read() == "height"

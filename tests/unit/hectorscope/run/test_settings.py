import pytest

from hectorscope.run.settings import Change, Settings, value_of
from slam_core.config import ConfigError, SlamConfig, with_value


def test_a_change_acts_from_its_time_on():
    """Before it the start, after it the new value; the start stays what it was."""
    settings = Settings().changed(100, "fusion.omega", 0.5)
    assert settings.at(99) == SlamConfig()
    assert settings.at(100).fusion.omega == 0.5
    assert settings.start == SlamConfig()


def test_a_hand_on_the_slider_overrides_what_was_planned_later():
    """A change drops later ones of the same setting and leaves the others."""
    settings = Settings(changes=(Change(50, "fusion.omega", 0.2), Change(60, "matcher.sigma", 0.3)))
    changed = settings.changed(40, "fusion.omega", 0.9)
    assert changed.at(1000).fusion.omega == 0.9
    assert changed.at(1000).matcher.sigma == 0.3


def test_a_setting_of_the_map_changes_from_the_start():
    """What needs a new map cannot change in the middle."""
    settings = Settings().changed(100, "map.levels", 2)
    assert settings.start.map.levels == 2
    assert settings.changes == ()


def test_settings_change_together():
    """Those that a running map can follow from their time on, the others from the start."""
    planned = Settings(changes=(Change(150, "fusion.omega", 0.2),))
    settings = planned.changed_all(100, {"fusion.omega": 0.5, "map.levels": 2, "matcher.sigma": 0.3})
    assert settings.start == with_value(SlamConfig(), "map.levels", 2)
    assert settings.changes == (Change(100, "fusion.omega", 0.5), Change(100, "matcher.sigma", 0.3))


def test_however_often_a_slider_moved_a_configuration_is_made_once(monkeypatch: pytest.MonkeyPatch):
    """A class that plays with a slider for an hour: the next move must not go through all of those before."""
    settings, made = Settings(), []
    for time_ns in range(100):
        settings = settings.changed(time_ns, "fusion.omega", 0.1 + 0.001 * time_ns)
    monkeypatch.setattr(SlamConfig, "__post_init__", lambda config: made.append(config.fusion.omega))
    later = settings.changed(200, "fusion.omega", 0.5)
    assert later.at(150).fusion.omega == pytest.approx(0.199)
    assert later.at(160) is later.at(150)
    assert made == [pytest.approx(0.199)]


def test_a_change_for_the_whole_run_replaces_what_was_planned():
    """The start has the value, and no later change of that setting is left."""
    settings = Settings(changes=(Change(50, "fusion.omega", 0.2), Change(90, "matcher.sigma", 0.3)))
    throughout = settings.changed_all(None, {"fusion.omega": 0.4})
    assert throughout.start.fusion.omega == 0.4
    assert [change.name for change in throughout.changes] == ["matcher.sigma"]


@pytest.mark.parametrize(
    ("name", "value"), [("fusion.omega", 7.0), ("fusion.omego", 0.5), ("matcher.sigma", "big")]
)
def test_bad_changes_are_refused(name: str, value: object):
    """Unknown names, values out of range and of the wrong type raise and change nothing."""
    with pytest.raises(ConfigError, match=name):
        Settings().changed(0, name, value)  # type: ignore[arg-type]


def test_a_plan_that_would_rebuild_the_map_is_refused():
    """A file cannot plan a new resolution for later."""
    with pytest.raises(ConfigError, match=r"map\.resolution cannot change at 5 ns"):
        Settings(changes=(Change(5, "map.resolution", 0.1),))


def test_value_of_finds_a_setting_by_name():
    """The dotted name leads to the value; an unknown one is named."""
    assert value_of(with_value(SlamConfig(), "map.levels", 2), "map.levels") == 2
    with pytest.raises(ConfigError, match="nothing"):
        value_of(SlamConfig(), "nothing")

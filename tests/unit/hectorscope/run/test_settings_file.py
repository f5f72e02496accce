from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.run.settings import Change, Settings
from hectorscope.run.settings_file import SettingsError, read_file, read_toml, to_toml
from slam_core.config import Leaf, SlamConfig, leaves, with_value


def values(leaf: Leaf) -> st.SearchStrategy[object]:
    """Any value that a setting accepts."""
    if leaf.choices:
        return st.sampled_from(leaf.choices)
    if leaf.type is bool:
        return st.booleans()
    if leaf.type is int:
        return st.integers(int(leaf.param.low or 0), int(leaf.param.high or 0))
    return st.floats(leaf.param.low, leaf.param.high)


@given(st.data())
def test_settings_survive_the_file(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject):
    """Whatever the settings and their changes are, reading the written file gives the same."""
    config = SlamConfig()
    for leaf in data.draw(st.lists(st.sampled_from(list(leaves(config))), max_size=6)):
        config = with_value(config, leaf.name, data.draw(values(leaf)))
    times = sorted(data.draw(st.lists(st.integers(0, 2**62), max_size=3)))
    settings = Settings(config, tuple(Change(t, "fusion.omega", data.draw(st.floats(0.01, 0.9))) for t in times))
    path = tmp_path_factory.mktemp("toml") / "config.toml"
    path.write_text(to_toml(settings))
    assert read_toml(path) == settings


def test_every_setting_stands_in_the_file_with_its_range():
    """A person can read the file: groups, names, units."""
    text = to_toml(Settings())
    assert "[matcher]\n" in text
    assert "sigma = 0.2  # 0.001 to 10" in text
    for leaf in leaves(SlamConfig()):
        assert f"{leaf.name.split('.')[1]} = " in text


def test_what_the_file_does_not_name_keeps_its_default(tmp_path: Path):
    """A short file is enough."""
    path = tmp_path / "short.toml"
    path.write_text("[fusion]\nomega = 0.3\n")
    assert read_toml(path) == Settings(with_value(SlamConfig(), "fusion.omega", 0.3))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[matcher]\nsgima = 0.2", "matcher.sgima is no setting: did you mean matcher.sigma?"),
        ("[weather]\nrain = true", "weather.rain is no setting: choose one"),
        ("omega = 0.2", "omega stands outside of a group"),
        ("[fusion]\nomega = 7.0", "fusion.omega is 7: give 0.001 to 0.999"),
        ("[fusion]\nomega = " + "9" * 400, "fusion.omega is inf: give a finite number"),
        ("[fusion]\nomega = -" + "9" * 400, "fusion.omega is -inf: give a finite number"),
        ("[fusion]\nomega = " + "9" * 5000, "is not valid TOML"),
        ("[fusion]\nomega = 0x" + "f" * 5000, "fusion.omega is inf: give a finite number"),
        ("[scan]\nstabilise = 0x" + "f" * 5000, "is not valid TOML"),
        ("a = " + "[" * 20000, "is not valid TOML"),
        ("[scan]\nstabilise = 1", "scan.stabilise is 1: give true or false"),
        ("[fusion\nomega = 0.1", "is not valid TOML"),
        ("changes = 3", "changes is 3"),
        ("[[changes]]\nname = 'fusion.omega'", "is incomplete: give time_ns, name and value"),
        ("[[changes]]\ntime_ns = 'now'\nname = 'fusion.omega'\nvalue = 0.2", "has a bad time_ns"),
        ("[[changes]]\ntime_ns = true\nname = 'fusion.omega'\nvalue = 0.2", "has a bad time_ns"),
        (f"[[changes]]\ntime_ns = {2**63}\nname = 'fusion.omega'\nvalue = 0.2", "has a bad time_ns"),
        ("[[changes]]\ntime_ns = 1\nname = 'fusion.omega'\nvalue = " + "9" * 400, "fusion.omega is inf"),
        ("[[changes]]\ntime_ns = 1\nname = 'fusion.omego'\nvalue = 0.2", "did you mean fusion.omega?"),
        ("[[changes]]\ntime_ns = 1\nname = 'map.levels'\nvalue = 2", "map.levels cannot change at 1 ns"),
    ],
)
def test_a_bad_file_is_refused_with_its_name_and_a_remedy(tmp_path: Path, text: str, words: str):
    """The message names the file, the entry and what to do."""
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(SettingsError) as caught:
        read_toml(path)
    assert str(path) in str(caught.value)
    assert words in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path):
    """No such file: said so."""
    with pytest.raises(SettingsError, match=r"none\.toml cannot be read"):
        read_toml(tmp_path / "none.toml")


def test_a_file_of_version_0_1_is_read(tmp_path: Path) -> None:
    """Renamed settings keep their values, in tables and in changes; settings that are no more are passed over."""
    path = tmp_path / "old.toml"
    path.write_text(
        "[matcher]\nmax_yaw_step = 0.1\nblind_share = 0.04\n[tracking]\nmax_sigmas = 50.0\n"
        '[[changes]]\ntime_ns = 5\nname = "tracking.max_sigmas"\nvalue = 7.0\n'
        '[[changes]]\ntime_ns = 6\nname = "tracking.max_surprise"\nvalue = 3.0\n',
        encoding="utf-8",
    )
    settings = read_toml(path)
    assert settings.start == with_value(SlamConfig(), "matcher.degeneracy_threshold", 0.04)
    assert settings.changes == (Change(6, "tracking.unaided_mahalanobis_limit", 3.0),)


def test_what_is_stated_of_the_sensors_is_kept(tmp_path: Path) -> None:
    """Units, signs, angles and delays come back as they were, beside the settings."""
    stated = {
        "imu_accel_unit": "mg",
        "scan_mirrored": True,
        "imu_rotation": (3.1416, 0.0, 0.0),
        "scan_delay": 0.11,
    }
    path = tmp_path / "config.toml"
    path.write_text(to_toml(Settings(), stated))
    assert read_file(path) == (Settings(), stated)


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ('imu_accel_unit = "yards"', "give m/s2 or g or mg"),
        ("scan_mirrored = 1", "give true or false"),
        ("scan_delay = nan", "give a finite number"),
        ("imu_delay = -" + "9" * 400, "give a finite number"),
        ("imu_rotation = [1.0]", "give 3 finite numbers"),
        ("imu_rotation = [inf, 0, 0]", "give 3 finite numbers"),
        ('scan_topic = "/scan"', "there are imu_topic, "),
        ("x = 1", "there are imu_topic, "),
    ],
)
def test_a_bad_word_on_the_sensors_is_refused(tmp_path: Path, line: str, remedy: str) -> None:
    """The file, the entry, its value and what to give; nothing of it is passed over."""
    path = tmp_path / "config.toml"
    path.write_text(f"[sensors]\n{line}\n")
    with pytest.raises(SettingsError, match=rf"config\.toml: sensors\.{line.split(maxsplit=1)[0]} = .*: {remedy}"):
        read_toml(path)

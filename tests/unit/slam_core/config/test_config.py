"""The configuration tree: what it accepts, what it refuses and how it says so."""

import dataclasses

import pytest

from slam_core.config import (
    ADDITIONS,
    PRESETS,
    ConfigError,
    FusionConfig,
    MapConfig,
    SlamConfig,
    leaves,
    nearest_preset,
    needs_restart,
    preset,
    with_value,
    with_values,
)

LEAVES = list(leaves(SlamConfig()))


def test_names_are_unique_and_dotted():
    """Every setting has one name, GROUP.KEY."""
    names = [leaf.name for leaf in LEAVES]
    assert len(set(names)) == len(names)
    assert all(name.count(".") == 1 for name in names)


@pytest.mark.parametrize("leaf", LEAVES, ids=lambda leaf: leaf.name)
def test_every_setting_describes_itself(leaf):
    """Each setting has a help sentence and, when it is a number, a range that holds its default."""
    assert leaf.param.help.endswith(".")
    if leaf.type in (int, float):
        assert leaf.param.low <= leaf.value <= leaf.param.high
    if leaf.param.log:
        assert leaf.param.low > 0


@pytest.mark.parametrize("leaf", [x for x in LEAVES if x.type in (int, float)], ids=lambda leaf: leaf.name)
def test_out_of_range_is_refused_with_the_range(leaf):
    """The message names the setting, the value and the range."""
    with pytest.raises(ConfigError, match=f"{leaf.name} is .*give .* to "):
        with_value(SlamConfig(), leaf.name, leaf.type(leaf.param.high + 1))


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("map.resolutoin", 1, "map.resolutoin is no setting: did you mean map.resolution?"),
        ("fusion.sigma", 1, "did you mean matcher.sigma?"),
        ("Sigma", 1, "did you mean matcher.sigma?"),
        ("weather.rain", 1, "is no setting: choose one of the groups scan, map"),
        ("map.levels", 2.5, "give a whole number"),
        ("map.levels", True, "give a finite number"),
        ("fusion.omega", float("nan"), "give a finite number"),
        ("fusion.omega", 10**400, "is inf: give a finite number"),
        ("map.levels", -(10**400), "is -inf: give a finite number"),
        ("fusion.omega", "0.5", "give a finite number"),
        ("scan.deskew", 1, "give true or false"),
        ("matcher.covariance", "guess", "choose one of hessian, sampled"),
    ],
)
def test_wrong_kinds_are_refused(name, value, words):
    """Nothing is silently converted."""
    with pytest.raises(ConfigError, match=words):
        with_value(SlamConfig(), name, value)


def test_a_tree_out_of_range_cannot_be_made():
    """The check holds however the tree is built."""
    with pytest.raises(ConfigError, match=r"fusion.omega is 1.5: give 0.001 to 0.999"):
        SlamConfig(fusion=FusionConfig(omega=1.5))


def test_with_value_changes_one_setting_and_leaves_the_original():
    """Trees are values."""
    config = SlamConfig()
    changed = with_value(config, "fusion.omega", 0.7)
    assert (config.fusion.omega, changed.fusion.omega) == (FusionConfig().omega, 0.7)
    assert dataclasses.replace(changed, fusion=config.fusion) == config


def test_whole_numbers_may_come_as_floats():
    """A slider's 4.0 is the integer 4."""
    value = with_value(SlamConfig(), "map.levels", 4.0).map.levels
    assert value == 4
    assert isinstance(value, int)


def test_only_marked_settings_need_a_restart():
    """Changing the map's geometry does, changing a threshold does not."""
    config = SlamConfig()
    assert needs_restart(config, with_value(config, "map.resolution", 0.1))
    assert not needs_restart(config, with_value(config, "map.update_angle", 0.1))
    assert not needs_restart(config, SlamConfig(map=MapConfig()))


def test_the_paper_differs_from_the_defaults_in_every_addition_and_in_nothing_else():
    """Each setting of an addition has another value, and no other setting has."""
    defaults = {leaf.name: leaf.value for leaf in LEAVES}
    changed = {leaf.name: leaf.value for leaf in leaves(SlamConfig.paper()) if leaf.value != defaults[leaf.name]}
    assert changed == PRESETS["paper"]
    assert changed.keys() == {name for addition in ADDITIONS for name in addition.values}


@pytest.mark.parametrize("name", PRESETS)
def test_a_configuration_knows_its_nearest_preset(name):
    """And in which settings it differs from that, with the values that it would have to take."""
    assert nearest_preset(preset(name)) == (name, {})
    changed = with_values(preset(name), {"map.levels": 2, "matcher.surfel_weight": 1.0})
    nearest, values = nearest_preset(changed)
    assert (nearest, values.keys()) == (name, {"map.levels", "matcher.surfel_weight"})
    assert with_values(changed, values) == preset(name)


def test_a_preset_can_be_taken_on_by_a_running_map():
    """None of its settings needs a new map."""
    assert not needs_restart(SlamConfig(), SlamConfig.paper())


def test_few_settings_are_basic():
    """With the preset a person meets at most twenty, the thresholds, sigma and omega first; others on request."""
    first = [leaf.name for leaf in LEAVES if leaf.param.tier == "first"]
    assert first == ["map.update_distance", "map.update_angle", "matcher.sigma", "fusion.omega"]
    assert 15 <= sum(leaf.param.tier != "expert" for leaf in LEAVES) < 20

"""The cases of the tables are what they say."""

from benchmarks.cases import (
    DEMOS,
    DRIVE_SEEDS,
    DRIVES,
    METHODS,
    REAL,
    SEEDS,
    TIMED,
    Recording,
    present,
)
from slam_core.config import SlamConfig, leaves
from slam_core.config.presets import PAPER


def test_names_are_unique() -> None:
    """No row of a table can be taken for another, and no seed counts twice."""
    for cases in (DRIVES, (*DEMOS, *REAL)):
        assert len({case.name for case in cases}) == len(cases)
    assert len(set(SEEDS)) == len(SEEDS) >= 3
    assert len(set(DRIVE_SEEDS)) == len(DRIVE_SEEDS) >= 20


def test_the_paper_s_method_differs_by_its_named_settings_alone() -> None:
    """Paper is the defaults with each of the named settings changed; full is the defaults."""
    defaults = {leaf.name: leaf.value for leaf in leaves(SlamConfig())}
    changed = {leaf.name: leaf.value for leaf in leaves(METHODS["paper"]) if leaf.value != defaults[leaf.name]}
    assert changed == PAPER
    assert METHODS["full"] == SlamConfig()


def test_what_is_missing_is_left_out(tmp_path) -> None:
    """A recording that does not lie beside the project is no error; the demos are always there."""
    assert present((Recording("nowhere", tmp_path / "none.bag"),)) == []
    assert present(DEMOS) == list(DEMOS)
    assert TIMED[: len(DEMOS)] == DEMOS

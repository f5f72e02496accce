"""A sample of the damaged recordings, maps and settings: reading and refusing is all that comes of them."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.damaged import FORMATS, Format, damage, run, settings
from slam_core.errors import SlamError

SEEDS = range(1, 4)


@pytest.mark.parametrize("kind", FORMATS, ids=[kind.name for kind in FORMATS])
def test_damaged_files_are_read_or_refused(kind: Format, tmp_path: Path) -> None:
    """Some files of each format; `python -m benchmarks.damaged` tries thousands."""
    counts, failed = run(kind, SEEDS, tmp_path)
    assert not failed
    assert counts.total() == len(SEEDS)


def test_the_damage_is_that_of_its_seed() -> None:
    """The same seed spoils the same bytes, another one others."""
    data = bytes(range(256)) * 10
    same, again, other = (damage(data, np.random.default_rng(seed)) for seed in (5, 5, 6))
    assert same == again != data
    assert other != same


def test_what_goes_wrong_is_found(tmp_path: Path) -> None:
    """A reader that fails in another way than by refusing is reported with its last lines."""

    def read(path: Path) -> bool:
        if path.parent == tmp_path:  # the damaged copy
            raise ZeroDivisionError("by chance")
        return False

    def refuse(path: Path) -> bool:
        if path.parent == tmp_path:
            raise SlamError("no")
        return False

    counts, failed = run(Format("config.toml", settings, read), range(2), tmp_path)
    assert counts == {"traceback": 2}
    assert "ZeroDivisionError: by chance" in failed[0]
    assert run(Format("config.toml", settings, refuse), range(2), tmp_path) == ({"refused": 2}, {})

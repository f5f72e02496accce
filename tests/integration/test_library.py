"""The core as a library: the examples of the documents run, and the import is light."""

import re
import subprocess
import sys

import pytest

import slam_core
from tests.conftest import ROOT

FENCED = re.compile(r"```python\n(.*?)```", re.DOTALL)


def example(document: str) -> str:
    """The first Python block of a document."""
    found = FENCED.search((ROOT / document).read_text(encoding="utf-8"))
    assert found is not None
    return found[1]


def fresh(code: str) -> str:
    """What a fresh process prints for the code."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("document", ["README.md", "docs/library.md"])
def test_the_example_runs(document: str):
    """At most ten lines; a laser at rest stays within a millimetre of the origin, and there is a map."""
    code = example(document)
    assert sum(bool(line.strip()) for line in code.splitlines()) <= 10
    check = "\nassert abs(slam.trajectory.positions).max() < 1e-3 and slam.map.probability().max() > 0.8"
    assert "(1024, 1024)" in fresh(code + check)


def test_the_import_is_light():
    """`import slam_core` loads neither numba nor the application."""
    fresh("import slam_core, sys; assert not {'numba', 'hectorscope', 'viser'} & set(sys.modules)")


def test_every_public_name_is_there_and_documented():
    """Each name of __all__ can be had, and docs/library.md names it."""
    text = (ROOT / "docs" / "library.md").read_text(encoding="utf-8")
    for name in slam_core.__all__:
        assert getattr(slam_core, name) is not None
        assert re.search(rf"\b{name}\b", text), name
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        slam_core.Nothing  # noqa: B018


def test_results_come_from_add_and_from_finish():
    """Scans wait for inertial data at the start; `finish` returns the rest, and the trajectory has all of them."""
    out = fresh(
        example("docs/library.md").replace("slam.add(", "n = len(slam.add(").replace("angles[0]))", "angles[0])))")
        + "\nrest = slam.finish()\nprint(len(slam.trajectory.stamps_ns), slam.trajectory.stamps_ns[-1])"
    )
    assert out.splitlines()[-1] == "10 900000000"

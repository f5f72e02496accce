"""Files of relations."""

from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import SourceError
from hectorscope.run.relations import read_relations, relation_figures


def written(folder: Path, text: str) -> Path:
    path = folder / "some.relations"
    path.write_text(text)
    return path


def test_a_file_gives_times_and_planar_motions(tmp_path: Path):
    """A line each; remarks and empty lines are passed over, and so are z, roll and pitch."""
    path = written(tmp_path, "# made by hand\n\n1.5 3.5 1 2 9 8 7 0.5  # a remark\n2 4 0 0 0 0 0 -0.25\n")
    relations = read_relations(path)
    np.testing.assert_array_equal(relations.times, [[1.5, 3.5], [2.0, 4.0]])
    np.testing.assert_array_equal(relations.motions, [[1.0, 2.0, 0.5], [0.0, 0.0, -0.25]])


@pytest.mark.parametrize("line", ["1 2 3", "1 2 3 4 5 6 7 8 9", "1 2 x 4 5 6 7 8", "1 2 nan 0 0 0 0 0"])
def test_a_bad_line_is_named(tmp_path: Path, line: str):
    """With its number and what it should be."""
    with pytest.raises(SourceError, match=r"some.relations, line 2 .*write time1 time2"):
        read_relations(written(tmp_path, f"1 2 0 0 0 0 0 0\n{line}\n"))


def test_a_file_without_relations_is_refused(tmp_path: Path):
    """As is one that is not there."""
    with pytest.raises(SourceError, match="holds no relation"):
        read_relations(written(tmp_path, "# nothing\n"))
    with pytest.raises(SourceError, match="cannot be read"):
        read_relations(tmp_path / "missing")


def test_times_of_a_file_are_those_of_the_recording(tmp_path: Path):
    """A trajectory counts its seconds from the start of the recording, a relation has absolute ones."""
    n, start_ns = 21, 1_700_000_000_250_000_000
    rows = np.column_stack([0.5 * np.arange(n), np.arange(n), np.zeros((n, 2)), np.ones(n), np.zeros((n, 3))])
    relations = read_relations(written(tmp_path, "1700000001.25 1700000003.25 4.5 0 0 0 0 0\n3 4 0 0 0 0 0 0\n"))
    found = relation_figures(rows, start_ns, relations)
    assert (found["given"], found["used"]) == (2, 1)
    assert found["translation_mean_m"] == pytest.approx(0.5, abs=1e-5)
    assert found["rotation_std_deg"] == 0.0
    assert relation_figures(rows[:2], start_ns, relations) == {"given": 2, "used": 0}

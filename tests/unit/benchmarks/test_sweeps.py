"""What the scripts about sweeps compute."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.cases import DEMOS
from benchmarks.sweeps.cases import base_of, relation_lines, relations_of, truth_rows
from benchmarks.sweeps.marks import fill
from benchmarks.sweeps.published import figure, spread
from benchmarks.sweeps.score import rank_correlation
from hectorscope.run.relations import read_relations, relation_figures
from hectorscope.sweep.execute import execute


def test_the_rank_correlation_is_spearmans():
    """Orders that agree, that are opposite, with two places swapped, and with equal ones, which share a rank."""
    a = np.array([1.0, 2.0, 3.0, 4.0])
    assert rank_correlation(a, np.exp(a)) == pytest.approx(1.0)
    assert rank_correlation(a, -(a**3)) == pytest.approx(-1.0)
    assert rank_correlation(a, np.array([20.0, 10.0, 30.0, 40.0])) == pytest.approx(0.8)
    assert rank_correlation(a, np.array([1.0, 1.0, 2.0, 2.0])) == pytest.approx(2 / np.sqrt(5))


def test_relations_from_a_truth_score_that_truth_with_nothing():
    """Of a demo: times are those of the recording, and stretches are two metres long."""
    rows = truth_rows(DEMOS[0])
    lines = relation_lines(rows)
    assert len(lines) > 20
    motions = np.array([[float(word) for word in line.split()] for line in lines])
    assert (motions[:, 1] > motions[:, 0]).all()
    assert (np.hypot(motions[:, 2], motions[:, 3]) <= 2.05).all()
    assert motions[0, 0] >= rows[0, 0]


def test_a_run_of_a_demo_is_scored_by_its_relations(tmp_path: Path):
    """By way of the file: the truth itself has no error, and the run has millimetres."""
    found = relations_of(DEMOS[0], tmp_path)
    assert found is not None
    path, origin = found
    assert origin == "from the truth"
    itself = relation_figures(truth_rows(DEMOS[0]), 0, read_relations(path))
    assert itself["translation_mean_m"] == pytest.approx(0.0, abs=2e-5)
    spec = base_of(DEMOS[0])
    assert spec.recording == DEMOS[0].name
    assert execute(spec).figures["relations.used"] is None


def test_a_part_of_a_document_is_filled(tmp_path: Path):
    """Between its marks, again and again; without them nothing is written."""
    path = tmp_path / "a.md"
    path.write_text("before\n<!-- score -->\nold\n<!-- /score -->\nafter\n")
    for text in ("new\n", "newer"):
        fill(path, "score", text)
        assert path.read_text() == f"before\n<!-- score -->\n{text.strip()}\n<!-- /score -->\nafter\n"
    with pytest.raises(ValueError, match="has no place for other"):
        fill(path, "other", "x")


def test_what_there_is_not_is_a_dash():
    """In the benchmark's table."""
    row = {"a": "0.12345", "relations.rotation_mean_deg": "1", "relations.rotation_std_deg": "0.5"}
    assert (figure(row, "a", "m"), figure(row, "b", "m")) == ("0.123 m", "-")
    assert spread(row, "rotation", "deg") == "1.000 ± 0.500 deg"
    assert spread(row, "translation", "m") == "-"

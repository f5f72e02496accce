"""The table of a sweep on the disk."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from pyarrow import parquet

from hectorscope.exporters import OutputError
from hectorscope.sweep.spec import RunSpec, RunSummary
from hectorscope.sweep.table import BROKEN, Table, read, read_details, value, write_parquet
from slam_core.config import SlamConfig

SPECS = [RunSpec("a, b.bag", "/a.bag", {"matcher.sigma": sigma}) for sigma in (0.1, 0.2, 0.3)]
DONE = RunSummary("ok", figures={"consistency": 0.75}, wall_s=1.5, picture="AAAA", extent=(0.0, 0.0, 1.0, 1.0))


def made(folder: Path, specs: Sequence[RunSpec] = SPECS, summary: RunSummary = DONE) -> Table:
    table = Table(folder, ["matcher.sigma"])
    for spec in specs:
        table.append(spec, summary)
    return table


def test_a_row_is_there_at_once(tmp_path: Path):
    """Whoever reads the file between two runs sees those that ended, with settings and figures."""
    made(tmp_path, SPECS[:1])
    (row,) = read(tmp_path)
    wanted = {"recording": "a, b.bag", "matcher.sigma": "0.1", "status": "ok", "consistency": "0.75"}
    assert wanted.items() <= row.items()
    assert row["truth.aligned_rmse_m"] == ""
    assert read_details(tmp_path, SPECS[0].key)["picture"] == "AAAA"


def test_a_row_that_was_cut_is_done_again(tmp_path: Path):
    """At every byte: a sweep that was killed while it wrote loses that row alone, and the file is whole again."""
    made(tmp_path)
    path = tmp_path / "runs.csv"
    content = path.read_bytes()
    last = content[:-1].rfind(b"\n") + 1
    for cut in (last, last + 1, len(content) - 20, len(content) - 1):
        path.write_bytes(content[:cut])
        table = Table(tmp_path, ["matcher.sigma"])
        assert [spec.key in table for spec in SPECS] == [True, True, False]
        assert path.read_bytes() == content[:last]


def test_rows_end_in_the_order_of_the_specs(tmp_path: Path):
    """Whatever order the runs ended in: the bytes are the same."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    made(tmp_path / "a").finish(SPECS)
    made(tmp_path / "b", SPECS[::-1]).finish(SPECS)
    assert (tmp_path / "a" / "runs.csv").read_bytes() == (tmp_path / "b" / "runs.csv").read_bytes()


def test_another_setting_is_another_column(tmp_path: Path):
    """The rows before have nothing there; the columns before stay."""
    made(tmp_path, SPECS[:1])
    table = Table(tmp_path, ["map.levels"])
    table.append(RunSpec("b", "/b", {"map.levels": 2}), DONE)
    old, new = read(tmp_path)
    assert (old["matcher.sigma"], old["map.levels"]) == ("0.1", "")
    assert (new["matcher.sigma"], new["map.levels"]) == (str(SlamConfig().matcher.sigma), "2")


def test_runs_that_failed_are_forgotten_on_demand(tmp_path: Path):
    """And those that ended with figures are not."""
    table = made(tmp_path, SPECS[:1])
    table.append(SPECS[1], RunSummary("timeout", "it took\nlong"))
    table.append(SPECS[2], RunSummary("lost"))
    table.forget(BROKEN)
    assert [row["status"] for row in read(tmp_path)] == ["ok", "lost"]


def test_a_file_of_another_program_is_left_alone(tmp_path: Path):
    """It is named, and not written over."""
    (tmp_path / "runs.csv").write_text("day,distance\nmonday,12\n")
    with pytest.raises(OutputError, match="is no table of a sweep"):
        Table(tmp_path, [])
    assert (tmp_path / "runs.csv").read_text().startswith("day")


def test_parquet_holds_the_same_with_types(tmp_path: Path):
    """Numbers are numbers, and a column without any value is there too."""
    table = made(tmp_path)
    table.append(RunSpec("c", "/c", {"matcher.sigma": 0.4}), RunSummary("crashed", "gone"))
    columns = parquet.read_table(write_parquet(tmp_path)).to_pydict()
    assert columns["matcher.sigma"] == [0.1, 0.2, 0.3, 0.4]
    assert columns["consistency"] == [0.75, 0.75, 0.75, None]
    assert columns["status"] == ["ok", "ok", "ok", "crashed"]
    assert columns["key"] == [row["key"] for row in read(tmp_path)]


@pytest.mark.parametrize(
    ("cell", "wanted"),
    [("", None), ("1.5", 1.5), ("true", True), ("fixed", "fixed"), ("nan", "nan"), ("inf", "inf")],
)
def test_cells_are_read_as_what_they_are(cell: str, wanted: object):
    """Words stay words, also those that are no numbers in JSON."""
    assert value(cell) == wanted


def test_a_table_that_cannot_be_written_is_named(tmp_path: Path):
    """At the start, at the end, and beside it: the folder, the reason, the remedy."""
    table = made(tmp_path, SPECS[:1])
    write_parquet(tmp_path)
    for name in ("runs.csv", "runs.parquet"):
        (tmp_path / name).rename(tmp_path / f"{name}.before")
        (tmp_path / name).mkdir()
    for write in (lambda: table.finish(SPECS), lambda: table.forget(BROKEN)):
        with pytest.raises(OutputError, match=r"cannot be written to \(Is a directory\): make room"):
            write()

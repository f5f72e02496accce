"""Sweeps by the command line."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from hectorscope.simulation.sensors import START_NS
from hectorscope.sweep import executors
from hectorscope.sweep.table import read
from tests.commands import MISTAKE, called, hectorscope, refused
from tests.sweeps import PATIENCE_S, WITH_TRUTH, children, until


def test_the_command_makes_the_product_and_goes_on(short_bag: Path, tmp_path: Path):
    """Twice: the second time nothing is run; a third time more values are, and the best settings are printed."""
    flags = ["sweep", short_bag, "--out", tmp_path, "--workers", 2, "--fusion.omega", 0.05, "--parquet"]
    first = hectorscope(*flags, "--vary", "matcher.sigma=0.1,0.4", "--vary", "map.levels=2:3:2")
    assert first.returncode == 0, first.stderr
    assert "4 runs: 4 ok" in first.stdout
    assert "Best settings by truth.aligned_rmse_m" in first.stdout
    content = (tmp_path / "runs.csv").read_bytes()
    again = hectorscope(*flags, "--vary", "matcher.sigma=0.1,0.4", "--vary", "map.levels=2:3:2")
    assert again.returncode == 0, again.stderr
    assert (tmp_path / "runs.csv").read_bytes() == content
    assert hectorscope(*flags, "--vary", "matcher.sigma=0.1:0.4:3", "--vary", "map.levels=2,3").returncode == 0
    assert len(read(tmp_path)) == 6
    assert (tmp_path / "runs.parquet").exists()
    spec = json.loads(next((tmp_path / "details").iterdir()).read_text())["spec"]
    assert spec["settings"]["fusion.omega"] == 0.05


def test_a_sweep_is_shown_or_run(tmp_path: Path):
    """Not both by one command."""
    for flags in (["--out", tmp_path], ["some.bag"]):
        assert "looks at a sweep and runs nothing" in refused("sweep", *flags, "--show", tmp_path)


@pytest.mark.slow
def test_a_search_by_halving_ends_with_whole_runs_of_the_best(short_bag: Path, tmp_path: Path):
    """Nine settings on a ninth of the time, three on a third, one on all of it: the best of those before."""
    flags = ["sweep", short_bag, "--out", tmp_path, "--search", 9, "--halving", "--workers", 2]
    found = hectorscope(*flags, "--vary", "fusion.omega=0.001:0.9:log", "--target", "consistency")
    assert found.returncode == 0, found.stderr
    rows = read(tmp_path)
    shares = [float(row["share"]) for row in rows]
    assert [shares.count(share) for share in sorted(set(shares))] == [9, 3, 1]
    thirds = [row for row in rows if 0.2 < float(row["share"]) < 0.5]
    best = max(thirds, key=lambda row: (row["status"] == "ok", float(row["consistency"])))
    assert rows[-1]["fusion.omega"] == best["fusion.omega"]


@pytest.mark.slow
def test_a_recording_by_address_is_run_as_that_on_the_disk(short_bag: Path, tmp_path: Path):
    """Fsspec brings it; figures are equal, and the table has the address."""
    flags = ["--vary", "matcher.sigma=0.1", "--workers", 1]
    assert hectorscope("sweep", short_bag.as_uri(), "--out", tmp_path / "a", *flags).returncode == 0
    assert hectorscope("sweep", short_bag, "--out", tmp_path / "b", *flags).returncode == 0
    (by_address,), (by_path,) = read(tmp_path / "a"), read(tmp_path / "b")
    assert by_address["recording"] == short_bag.as_uri()
    assert by_address[WITH_TRUTH] == by_path[WITH_TRUTH] != ""


def test_an_interrupted_sweep_ends_at_once_and_keeps_its_rows(short_bag: Path, long_bag: Path, tmp_path: Path):
    """Exit code 130, no process left, the short run in the table and not the one that was stopped."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "sweep", short_bag, long_bag, "--out", tmp_path]
    flags = ["--workers", "1", "--vary", "matcher.sigma=0.1", "--time-limit", "0"]
    begun = subprocess.Popen([*map(str, command), *flags], stderr=subprocess.PIPE, text=True)
    until(lambda: (tmp_path / "runs.csv").exists() and read(tmp_path))
    workers = children(begun.pid)
    assert workers
    begun.send_signal(signal.SIGINT)
    begun.communicate(timeout=PATIENCE_S)
    assert begun.returncode == 130
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)
    assert [row["recording"] for row in read(tmp_path)] == [str(short_bag)]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ([], "--out is missing"),
        (["--out", "OUT"], "there is no recording"),
        (["BAG", "--out", "OUT", "--vary", "matcher.sigmo=1"], "did you mean matcher.sigma?"),
        (["BAG", "--out", "OUT", "--halving"], "--halving is a way to search"),
        (["BAG", "--out", "OUT", "--search", "-1"], "--search -1 is less than nothing"),
        (["BAG", "--out", "OUT", "--runs", "BAG", "--vary", "matcher.sigma=1"], "leave --vary and --search out"),
        (["BAG", "--out", "OUT", "--target", "speed"], "--target speed is no figure"),
        (["BAG", "--out", "OUT", "--time-limit", "-1"], "--time-limit is -1"),
        (["BAG", "--out", "OUT", "--cluster", "tcp://127.0.0.1:9"], "no Dask scheduler answers"),
        (["BAG", "--out", "OUT", "--relations", "BAG"], "--relations"),
        (["--show", "OUT"], "has no runs.csv"),
    ],
)
def test_mistakes_are_named_before_anything_is_run(
    flags: list[str], message: str, short_bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """One line, exit code 2, no row."""
    monkeypatch.setattr(executors, "PATIENCE_S", 0.5)  # nothing listens there
    names = {"BAG": str(short_bag), "OUT": str(tmp_path / "out")}
    refused = called("sweep", *(names.get(flag, flag) for flag in flags))
    assert refused.returncode == MISTAKE, refused.stderr
    assert "Traceback" not in refused.stderr
    assert message in refused.stderr
    assert not (tmp_path / "out" / "runs.csv").exists()


def test_relations_score_a_run(short_bag: Path, tmp_path: Path):
    """`run --relations` prints them and leaves them in metrics.json; a sweep has the same figures in its table."""
    path = tmp_path / "some.relations"
    pairs = [
        (START_NS / 1e9 + begin, START_NS / 1e9 + end) for begin, end in ((1.0, 2.0), (1.5, 2.5), (90.0, 91.0))
    ]
    path.write_text("".join(f"{begin:.3f} {end:.3f} 1 0 0 0 0 0\n" for begin, end in pairs))
    done = called("run", short_bag, "--out", tmp_path / "run", "--relations", path)
    assert done.returncode == 0, done.stderr
    assert "over 2 of 3" in done.stdout
    found = json.loads((tmp_path / "run" / "metrics.json").read_text())["relations"]
    assert (found["given"], found["used"]) == (3, 2)
    assert hectorscope("sweep", short_bag, "--out", tmp_path / "sweep", "--relations", path).returncode == 0
    (row,) = read(tmp_path / "sweep")
    for name, value in found.items():
        assert float(row[f"relations.{name}"]) == value

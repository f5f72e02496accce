"""The commands as a person calls them: settings, results, and what a run leaves and says."""

import hashlib
import json
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from hectorscope.cli.options import setting_flags
from hectorscope.exporters import exporters, reserved
from hectorscope.run.settings_file import read_toml
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, leaves, with_values
from slam_core.measurements import LaserScan
from tests.bags import small_run
from tests.commands import called, hectorscope, refused
from tests.ros_messages import SECOND, Messages, write_bag

LOST = 3


def test_help_names_every_command():
    """A newcomer sees what there is."""
    done = hectorscope("--help")
    assert done.returncode == 0
    for command in ("demo", "view", "live", "run", "inspect", "simulate"):
        assert command in done.stdout


def test_the_version_is_told():
    """The one that a report of an error has to name."""
    done = hectorscope("--version")
    assert (done.returncode, done.stdout) == (0, f"hectorscope {version('hectorscope')}\n")


def test_help_explains_every_setting_with_its_range():
    """Every leaf of the settings is a flag with its help, default and range."""
    shown = " ".join(hectorscope("run", "--help-all").stdout.replace("│", " ").split())
    for leaf in leaves(SlamConfig()):
        assert f"--{leaf.name.replace('_', '-')} " in shown
        assert leaf.param.help in shown
    assert f"default: {SlamConfig().fusion.omega}; 0.001 to 0.999" in shown


def test_flags_and_file_make_the_settings(tmp_path: Path):
    """The file changes the defaults, a flag wins over the file."""
    path = tmp_path / "some.toml"
    path.write_text("[fusion]\nomega = 0.3\n[scan]\ndeskew = false\n")
    flags = setting_flags()(config=path)
    flags.fusion.omega = 0.7  # type: ignore[attr-defined]
    flags.scan.stabilise = "false"  # type: ignore[attr-defined]
    config = flags.settings().start
    assert (config.fusion.omega, config.scan.deskew, config.scan.stabilise) == (
        0.7,
        False,
        False,
    )


def test_the_file_overrides_the_preset_and_flags_override_both(tmp_path: Path):
    """What neither names has the value of the preset."""
    path = tmp_path / "config.toml"
    path.write_text("[matcher]\nsurfel_weight = 1.0\nprior_weight = 0.5\n")
    flags = setting_flags()(preset="paper", config=path)
    flags.matcher.prior_weight = 2.0  # type: ignore[attr-defined]
    wanted = {"matcher.surfel_weight": 1.0, "matcher.prior_weight": 2.0}
    assert flags.settings().start == with_values(SlamConfig.paper(), wanted)


def test_export_chooses_the_files(bag: Path, tmp_path: Path):
    """Those that are named, and no other."""
    done = called("run", bag, "--out", tmp_path, "--export", "kitti,csv")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"trajectory.kitti", "times.txt", "series.csv"}


def test_export_all_leaves_every_format(bag: Path, tmp_path: Path):
    """Of a real run without marks; the report names the recording by its hash, and nothing unfinished stays."""
    done = called("run", bag, "--out", tmp_path, "--export", "all")
    assert done.returncode == 0, done.stderr
    names = {name for exporter in exporters() for name in exporter.files}
    assert {path.name for path in tmp_path.iterdir()} == {*names, "replay.html"} - {"pictures.zip"}
    assert hashlib.sha256(bag.read_bytes()).hexdigest() in (tmp_path / "report.html").read_text()


def test_a_folder_holds_the_newest_run_and_earlier_ones_below(bag: Path, tmp_path: Path):
    """Its map can be the start of the next run, which moves all of its files and says where to."""
    first = called("run", bag, "--out", tmp_path, "--export", "default,html,report")
    assert first.returncode == 0, first.stderr
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    again = called("run", bag, "--out", tmp_path, "--map", tmp_path, "--export", "tum")
    assert again.returncode == 0, again.stderr
    (place,) = (tmp_path / "earlier").iterdir()
    assert f"The results of an earlier run are now in {place}" in again.stdout
    assert {path.name: path.read_bytes() for path in place.iterdir()} == before
    assert {path.name for path in tmp_path.iterdir()} == {"trajectory.tum", "earlier"}


def test_a_run_leaves_its_files_and_prints_the_figures(bag: Path, tmp_path: Path):
    """All promised files are there, the metrics add up, the table has the error against the truth."""
    done = hectorscope("run", bag, "--out", tmp_path / "new" / "folder", "--truth", "/ground_truth")
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "new" / "folder"
    names = {"trajectory.tum", "map.npz", "map.pgm", "map.yaml", "config.toml", "metrics.json", "navigation.csv"}
    assert {path.name for path in folder.iterdir()} == names
    figures = json.loads((folder / "metrics.json").read_text())
    scans = figures["scans"]
    assert scans["read"] == 60
    assert scans["used"] + sum(scans["skipped"].values()) == scans["read"]
    assert scans["used"] == len((folder / "trajectory.tum").read_text().splitlines())
    assert figures["recording_s"] == pytest.approx(3.0, abs=0.1)
    assert set(figures["median_us"]) == {"stabilise", "match", "update", "filter"}
    assert figures["truth"]["aligned_rmse_m"] <= figures["truth"]["raw_rmse_m"]
    assert figures["map_updates"] > 0
    assert figures["occupied_cells"] > 0
    assert f"{figures['truth']['aligned_rmse_m']:.4f} m aligned" in done.stdout


def test_a_run_that_ends_lost_says_so(tmp_path: Path):
    """The table counts the states, the files are there, and the exit code is 3."""
    ros, rng, entries = Messages("ros1"), np.random.default_rng(1), []
    drive = list(Simulation("rooms", SceneOptions(duration=3.0, beams=181, scan_rate=20.0)).items())
    scans = [item for item in drive if isinstance(item, LaserScan)]
    for k, scan in enumerate(scans):
        ns = scan.stamp_ns - scans[0].stamp_ns
        ranges = scan.ranges if k < 10 else rng.uniform(0.5, 20.0, len(scan.ranges))
        entries.append(
            (
                "/scan",
                ros.scan(ns, ranges=ranges, angle_min=scan.angle_min, angle_increment=scan.angle_increment),
                ns,
            )
        )
    noise = write_bag(tmp_path / "noise.bag", entries)
    done = hectorscope("run", noise, "--out", tmp_path / "out")
    assert done.returncode == LOST, done.stderr
    assert done.stderr.splitlines()[-1].startswith("hectorscope: the pose was lost")
    figures = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert figures["tracking_at_end"] == "lost"
    assert f"{figures['tracking']['lost']} lost" in done.stdout
    assert (tmp_path / "out" / "map.npz").exists()


def test_a_run_that_could_use_few_scans_says_so(tmp_path: Path):
    """Its map is of no use, so the exit code is that of a lost run; the files are there."""
    ros = Messages("ros1")
    backwards = (1.0, 0.5, 0.2)
    scans = [ros.scan(round(t * SECOND), ranges=np.full(100, 2.0), angle_increment=0.01) for t in backwards]
    bag = write_bag(tmp_path / "run.bag", [("/scan", scan, k * SECOND) for k, scan in enumerate(scans)])
    done = called("run", bag, "--out", tmp_path / "out")
    assert done.returncode == LOST, done.stderr
    assert "hectorscope: 1 of 3 scans could be used, so the map cannot be trusted" in done.stderr
    assert (tmp_path / "out" / "map.npz").exists()


def test_a_truth_that_scores_nothing_costs_the_score_alone(tmp_path: Path):
    """Whether tf joins two frames shows at the end: the results are there, and the message says what is not."""
    ros = Messages("ros1")
    moved = [("/tf", ros.tf(k * SECOND, "odom", "base_link", (0.0, 0.0, 0.0)), k * SECOND) for k in range(3)]
    path = write_bag(tmp_path / "run.bag", [*small_run(ros), *moved])
    out = tmp_path / "out"
    told = refused("run", path, "--out", out, "--truth", "tf:a>b", "--imu-topic", "none")
    assert f"tf:a>b holds no truth at the times of the scans, so {out} has no score" in told
    assert (out / "map.npz").exists()
    assert json.loads((out / "metrics.json").read_text())["truth"] is None
    assert called("run", path, "--out", out, "--truth", "none", "--imu-topic", "none").returncode == 0


def test_one_folder_takes_the_results_of_one_run(bag: Path, tmp_path: Path):
    """A second program is told; the lock goes with the first one."""
    with reserved(tmp_path):
        assert f"another run writes into {tmp_path}" in refused("run", bag, "--out", tmp_path, by=hectorscope)
    assert called("run", bag, "--out", tmp_path).returncode == 0


def test_a_run_is_repeated_by_its_own_settings(bag: Path, tmp_path: Path):
    """config.toml of one run, given to another, makes the same trajectory to the last byte."""
    first, second = tmp_path / "first", tmp_path / "second"
    assert called("run", bag, "--out", first, "--fusion.omega", "0.4", "--map.levels", "2").returncode == 0
    assert read_toml(first / "config.toml").start.fusion.omega == 0.4
    assert called("run", bag, "--out", second, "--config", first / "config.toml").returncode == 0
    assert (first / "trajectory.tum").read_bytes() == (second / "trajectory.tum").read_bytes()
    assert (first / "config.toml").read_bytes() == (second / "config.toml").read_bytes()


def test_a_run_is_localised_in_the_map_of_another(bag: Path, tmp_path: Path):
    """The same map to the last byte afterwards, poses in its frame, and a note of where the robot was found."""
    first, second = tmp_path / "first", tmp_path / "second"
    assert called("run", bag, "--out", first).returncode == 0
    done = called("run", bag, "--out", second, "--map", first, "--start", "origin")
    assert done.returncode == 0, done.stderr
    assert (first / "map.npz").read_bytes() == (second / "map.npz").read_bytes()
    figures = json.loads((second / "metrics.json").read_text())
    assert figures["map_updates"] == 0
    assert any("the robot starts at" in note for note in figures["notes"])
    assert figures["truth"]["raw_rmse_m"] < 0.05


def test_inspect_says_what_would_be_used(bag: Path):
    """Topics and their parts."""
    done = hectorscope("inspect", bag)
    assert done.returncode == 0, done.stderr
    assert "/scan" in done.stdout


def test_sensors_that_contradict_their_messages_are_refused_with_the_remedy(wrong_units_bag: Path, tmp_path: Path):
    """`run` names --repair first, then the flags. Either gives the same trajectory; a repair is told once."""
    flags = ["--imu-accel-unit", "mg", "--imu-gyro-unit", "deg/s"]
    line = refused("run", wrong_units_bag, "--out", tmp_path / "out")
    assert "so in milli-g and not in m/s²" in line
    assert f"run again with --repair, or with {' '.join(flags)}, or without the IMU by --imu-topic none" in line
    assert not (tmp_path / "out").exists()
    done = called("run", wrong_units_bag, "--out", tmp_path / "out", *flags)
    assert done.returncode == 0, done.stderr
    mended = called("run", wrong_units_bag, "--out", tmp_path / "mended", "--repair", "--export", "default,report")
    assert mended.returncode == 0, mended.stderr
    told = (mended.stdout, (tmp_path / "mended" / "report.html").read_text())
    assert [text.lower().count("repaired: the accelerometer shows gravity") for text in told] == [1, 1]
    again = ("--config", tmp_path / "mended/config.toml")
    assert called("run", wrong_units_bag, "--out", tmp_path / "again", *again).returncode == 0
    first, *others = ((tmp_path / name / "trajectory.tum").read_bytes() for name in ("out", "mended", "again"))
    assert first == others[0] == others[1]


def test_an_inspection_shows_what_is_left_after_a_repair(wrong_units_bag: Path):
    """With --repair the recording is read again: what was repaired, and nothing wrong with it any more."""
    found = called("inspect", wrong_units_bag).stdout
    assert "repair: --repair, or --imu-accel-unit mg --imu-gyro-unit deg/s" in found
    mended = called("inspect", wrong_units_bag, "--repair").stdout
    assert "not in m/s²: --imu-accel-unit mg" in mended
    assert "sensor contradictions" not in mended

import hashlib
import json
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from hectorscope.cli.options import setting_flags
from hectorscope.exporters import exporters, reserved
from hectorscope.run.settings_file import read_toml
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig, leaves, with_values
from slam_core.measurements import Imu, LaserScan
from tests.bags import small_run
from tests.commands import MISTAKE, PATIENCE_S, called, hectorscope, refused
from tests.ros_messages import SECOND, Messages, write_bag

LOST, INTERRUPTED = 3, 130


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three simulated seconds as a ROS 1 bag, made by the command itself."""
    path = tmp_path_factory.mktemp("cli") / "short.bag"
    options = ["--duration", 3, "--beams", 181, "--scan-rate", 20]
    done = hectorscope("simulate", "--scenario", "rooms", *options, "--out", path)
    assert done.returncode == 0, done.stderr
    assert str(path) in done.stdout
    return path


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


def test_a_wrong_note_is_refused_before_the_work(bag: Path, tmp_path: Path):
    """With the form of one; no folder is made."""
    for words in ("soon", "5="):
        line = refused("run", bag, "--out", tmp_path / "out", "--export", "html", "--note", words)
        assert f"'{words}' is no note: give TIME=TEXT" in line
    assert not (tmp_path / "out").exists()


def test_a_note_that_nobody_would_see_is_refused_before_the_work(bag: Path, tmp_path: Path):
    """Without the replay, or behind the end of the recording."""
    out = ["--out", tmp_path / "out"]
    assert "add html to --export" in refused("run", bag, *out, "--note", "1=door")
    late = refused("run", bag, *out, "--export", "html", "--note", "9999=door")
    assert "at 9999 s is behind the end of short.bag: give 0 to" in late
    assert not (tmp_path / "out").exists()


def test_a_wrong_format_is_refused_before_the_work(bag: Path, tmp_path: Path):
    """With the nearest one; no folder is made."""
    assert "did you mean kitti?" in refused("run", bag, "--out", tmp_path / "out", "--export", "tum,kity")
    assert not (tmp_path / "out").exists()


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


def test_a_word_that_is_no_choice_gets_the_choices(bag: Path, tmp_path: Path):
    """In the order of the help, and none that is refused."""
    for flag, words in (("--scan-mirrored", "('true', 'false')"), ("--imu-accel-unit", "('m/s2', 'g', 'mg')")):
        done = called("run", bag, "--out", tmp_path / "out", flag, "maybe")
        assert done.returncode == MISTAKE
        assert words in " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.parametrize("flag", [["--out", ""], ["--out="]])
def test_an_empty_value_is_refused(bag: Path, flag: list[str]):
    """It is a variable of a script that was not set, and not the present folder."""
    assert "the value of --out is empty" in refused("run", bag, *flag)


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


def test_a_map_that_cannot_be_used_is_refused_before_any_work(bag: Path, tmp_path: Path):
    """Missing, contradicted by the mode, without the map that a mode needs, or a start that is no pose."""
    out = ["--out", tmp_path / "out"]
    assert "nowhere does not exist" in refused("run", bag, *out, "--map", tmp_path / "nowhere")
    assert "makes a new map" in refused("run", bag, *out, "--map", tmp_path, "--mode", "map")
    assert "needs a saved map" in refused("view", bag, "--mode", "continue", by=hectorscope)
    for x in ("nan", "1e300"):
        assert "is no pose" in refused("run", bag, *out, "--map", tmp_path, "--start", x, "0", "-1")
    for start in (["1", "2", "3"], ["nan", "0", "0"], ["origin"]):
        assert "is a place in a saved map" in refused("run", bag, *out, "--start", *start)
    assert not (tmp_path / "out").exists()


def test_inspect_says_what_would_be_used(bag: Path):
    """Topics and their parts."""
    done = hectorscope("inspect", bag)
    assert done.returncode == 0, done.stderr
    assert "/scan" in done.stdout


@pytest.fixture(scope="module")
def lying_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten simulated seconds whose IMU gives milli-g and degrees a second."""
    ros, entries = Messages("ros1"), []
    items = list(Simulation("rooms", SceneOptions(duration=10.0, beams=181, scan_rate=10.0)).items())
    for item in items:
        ns = item.stamp_ns - items[0].stamp_ns
        if isinstance(item, Imu):
            rates, forces = np.degrees(item.angular_velocity), item.linear_acceleration / 9.80665e-3
            entries.append(("/imu", ros.imu(ns, rates=rates, forces=forces), ns))
        elif isinstance(item, LaserScan):
            beams = {"angle_min": item.angle_min, "angle_increment": item.angle_increment}
            timing = {"time_increment": item.time_increment}
            entries.append(("/scan", ros.scan(ns, ranges=item.ranges, **beams, **timing), ns))
    return write_bag(tmp_path_factory.mktemp("lying") / "lying.bag", entries)


def test_devices_that_lie_are_refused_with_the_remedy(lying_bag: Path, tmp_path: Path):
    """`run` names --repair first, then the flags. Either gives the same trajectory; a repair is told once."""
    flags = ["--imu-accel-unit", "mg", "--imu-gyro-unit", "deg/s"]
    line = refused("run", lying_bag, "--out", tmp_path / "out")
    assert "so in milli-g and not in m/s²" in line
    assert f"run again with --repair, or with {' '.join(flags)}, or without the IMU by --imu-topic none" in line
    assert not (tmp_path / "out").exists()
    done = called("run", lying_bag, "--out", tmp_path / "out", *flags)
    assert done.returncode == 0, done.stderr
    mended = called("run", lying_bag, "--out", tmp_path / "mended", "--repair", "--export", "default,report")
    assert mended.returncode == 0, mended.stderr
    told = (mended.stdout, (tmp_path / "mended" / "report.html").read_text())
    assert [text.lower().count("repaired: the accelerometer shows gravity") for text in told] == [1, 1]
    again = ("--config", tmp_path / "mended/config.toml")
    assert called("run", lying_bag, "--out", tmp_path / "again", *again).returncode == 0
    first, *others = ((tmp_path / name / "trajectory.tum").read_bytes() for name in ("out", "mended", "again"))
    assert first == others[0] == others[1]


def test_an_inspection_shows_what_is_left_after_a_repair(lying_bag: Path):
    """With --repair the recording is read again: what was repaired, and nothing wrong with it any more."""
    found = called("inspect", lying_bag).stdout
    assert "repair: --repair, or --imu-accel-unit mg --imu-gyro-unit deg/s" in found
    mended = called("inspect", lying_bag, "--repair").stdout
    assert "not in m/s²: --imu-accel-unit mg" in mended
    assert "sensor contradictions" not in mended


def test_a_missing_recording_is_named(tmp_path: Path):
    """The path and what to do, for every command that takes one."""
    for command in (["run", "--out", tmp_path / "out"], ["inspect"]):
        assert "none.bag" in refused(command[0], tmp_path / "none.bag", *command[1:])
    assert "none.bag" in refused("view", tmp_path / "none.bag", by=hectorscope)


def test_a_value_out_of_range_is_refused_before_any_work(bag: Path, tmp_path: Path):
    """The flag's name, its value and its range; nothing is written."""
    line = refused("run", bag, "--out", tmp_path / "out", "--fusion.omega", "7")
    assert "fusion.omega is 7: give 0.001 to 0.999" in line
    assert not (tmp_path / "out").exists()


def test_a_seed_below_nothing_is_refused(bag: Path, tmp_path: Path):
    """By all who take one: the value and what is possible."""
    assert "seed is -1: give 0 to" in refused("drive", "--seed", "-1")
    searched = ("sweep", bag, "--out", tmp_path / "out", "--search", "2", "--vary", "matcher.sigma=0.1:0.4")
    assert "--seed -1 is less than nothing: give" in refused(*searched, "--seed", "-1")


@pytest.mark.parametrize("address", ["ws://127.0.0.1:9", "-", "dds://0"])
def test_a_stream_in_the_place_of_a_recording_is_refused(address: str, tmp_path: Path):
    """As it was written, with the command that takes it."""
    for command in (["view"], ["inspect"], ["run", "--out", tmp_path / "out"]):
        told = refused(command[0], address, *command[1:])
        assert told.endswith(f"{address} is a stream and no recording: use `hectorscope live {address}`")


@pytest.mark.parametrize(("host", "address"), [("robot:9090", "ws://robot:9090"), ("robot", "ws://robot:8765")])
@pytest.mark.parametrize("command", [("live",), ("serve", "--out", "out")])
def test_a_host_in_the_place_of_an_address_is_refused(command: tuple[str, ...], host: str, address: str):
    """With the address that is meant."""
    assert refused(command[0], host, *command[1:]).endswith(f"{host} is no address: write {address}")


def test_a_bad_settings_file_is_refused(bag: Path, tmp_path: Path):
    """The file and the place in it; what a terminal would obey is replaced."""
    path = tmp_path / "bad.toml"
    path.write_text("[fusion\n")
    assert "bad.toml is not valid TOML" in refused("run", bag, "--out", tmp_path / "out", "--config", path)
    path.write_text("[fusion]\nomego = 1\n")
    assert "did you mean fusion.omega?" in refused("run", bag, "--out", tmp_path / "out", "--config", path)
    path.write_text('[fusion]\n"\\u001b[31mred" = 1\n')
    line = refused("run", bag, "--out", tmp_path / "out", "--config", path)
    assert "fusion.\N{REPLACEMENT CHARACTER}[31mred is no setting" in line


def test_an_output_folder_that_cannot_be_is_refused(bag: Path, tmp_path: Path):
    """A file stands where the folder should be."""
    (tmp_path / "taken").write_text("")
    assert "taken cannot be made" in refused("run", bag, "--out", tmp_path / "taken")


def test_names_that_are_too_long_are_refused(bag: Path, tmp_path: Path):
    """Of the folder of kept runs, of a certificate and of a sweep: with the name."""
    name, proof = "x" * 300, tmp_path / "key.pem"
    assert f"--runs {name} cannot be written to" in refused("view", bag, "--runs", name)
    assert f"{name} is no file" in refused("view", bag, "--certificate", name, "--key", proof)
    assert f"{name} has no runs.csv" in refused("sweep", "--show", name)


def test_a_folder_that_takes_no_runs_is_refused_at_the_start(bag: Path):
    """As that for the results is: a file."""
    assert f"--runs {bag} cannot be written to (File exists)" in refused("view", bag, "--runs", bag)


def test_a_port_in_use_is_refused(bag: Path):
    """The port's number, instead of silently another one."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert str(port) in refused("view", bag, "--port", port, by=hectorscope)


def test_a_page_for_the_network_needs_a_token(bag: Path):
    """Serving more than this machine without a secret is refused."""
    assert "token" in refused("view", bag, "--host", "0.0.0.0", "--port", 0, by=hectorscope)


def test_an_unknown_flag_exits_with_two(bag: Path, tmp_path: Path):
    """The parser's own mistakes have the same exit code, and no traceback."""
    done = hectorscope("run", bag, "--out", tmp_path / "out", "--no-such-flag", "1")
    assert done.returncode == MISTAKE
    assert "Traceback" not in done.stderr


def interrupt(process: subprocess.Popen[str]) -> str:
    """Ctrl-C until it ends; what it said on stderr. A compiler or a loader at work can miss one."""
    deadline = time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < deadline:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            continue
    assert process.stderr is not None
    return process.stderr.read()


# The interpreter may end itself by the signal where generated code was running: a shell reads 130 from both.
ENDED_BY_INTERRUPTION = (INTERRUPTED, -signal.SIGINT)


def test_an_interruption_is_clean(tmp_path: Path):
    """Ctrl-C in the middle of long work: exit code 130, a word, no traceback."""
    command = [
        sys.executable,
        "-m",
        "hectorscope.cli.main",
        "simulate",
        "--scenario",
        "rooms",
        "--duration",
        "3600",
    ]
    work = subprocess.Popen([*command, "--out", str(tmp_path / "long.mcap")], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + PATIENCE_S
    while not any(tmp_path.iterdir()) and time.monotonic() < deadline and work.poll() is None:
        time.sleep(0.05)
    errors = interrupt(work)
    assert work.returncode in ENDED_BY_INTERRUPTION, errors
    assert "interrupted" in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("recording", ["bag", "lying_bag"])
def test_a_page_is_served_until_interrupted(recording: str, request: pytest.FixtureRequest):
    """The command prints its address, answers there, and ends cleanly at Ctrl-C; also for a refused recording."""
    path = request.getfixturevalue(recording)
    command = [sys.executable, "-u", "-m", "hectorscope.cli.main", "view", str(path), "--port", "0"]
    page = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert page.stdout is not None
    line = page.stdout.readline()
    assert "http://127.0.0.1:" in line
    with urllib.request.urlopen(f"{line.split()[-1]}healthz", timeout=PATIENCE_S) as answer:
        assert answer.status == 200
    errors = interrupt(page)
    assert page.returncode in ENDED_BY_INTERRUPTION, errors
    assert "Traceback" not in errors

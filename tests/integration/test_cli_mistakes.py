"""What a person gets wrong: one line with the fact, the value and the remedy; exit code 2; no work."""

import socket
from pathlib import Path

import pytest

from tests.commands import MISTAKE, called, hectorscope, refused


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

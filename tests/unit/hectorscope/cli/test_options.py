"""Flags: the secret that a browser must bring, and mistyped ones."""

import os
from pathlib import Path
from typing import get_args

import pytest

from hectorscope.cli.main import MISTAKE, main
from hectorscope.cli.options import ExportArg, setting_flags, source_flags, source_options
from hectorscope.cli.page_flags import TOKEN, PageFlags, TokenError
from hectorscope.exporters import chosen
from hectorscope.run.checkpoints import BUDGET_MB
from hectorscope.session.engine import LOOK_BACK_S
from slam_core.errors import SlamError


def secret_file(folder: Path, text: str = "of the file\n", mode: int = 0o600) -> Path:
    """A file with a token."""
    path = folder / "token"
    path.write_text(text, encoding="utf-8")
    path.chmod(mode)
    return path


def test_the_token_comes_from_flag_file_or_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In this order; the end of the line in a file does not belong to it."""
    monkeypatch.delenv(TOKEN, raising=False)
    assert PageFlags().secret() is None
    monkeypatch.setenv(TOKEN, "of the environment")
    assert PageFlags().secret() == "of the environment"
    assert PageFlags(token_file=secret_file(tmp_path)).secret() == "of the file"
    assert PageFlags(token="of the flag").secret() == "of the flag"


def test_two_tokens_are_refused(tmp_path: Path) -> None:
    """Nobody knows which one is meant."""
    with pytest.raises(TokenError, match="both given"):
        PageFlags(token="one", token_file=secret_file(tmp_path)).secret()


@pytest.mark.parametrize(
    ("text", "mode", "reason"), [("x", 0o640, "chmod 600"), ("x", 0o604, "chmod 600"), (" \n", 0o600, "is empty")]
)
def test_a_file_that_is_no_secret_is_refused(tmp_path: Path, text: str, mode: int, reason: str) -> None:
    """Others can read it, or it holds nothing; the message has the remedy."""
    with pytest.raises(TokenError, match=reason):
        PageFlags(token_file=secret_file(tmp_path, text, mode)).secret()


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    """With the path."""
    with pytest.raises(TokenError, match="nowhere"):
        PageFlags(token_file=tmp_path / "nowhere").secret()


def test_a_mistyped_setting_gets_the_nearest_one(capsys: pytest.CaptureFixture[str]) -> None:
    """Also one that --help does not list."""
    with pytest.raises(SystemExit) as ended:
        main(["run", "some.bag", "--out", "out", "--motion.acclerat", "1"])
    assert ended.value.code == MISTAKE
    assert "--motion.acceleration" in capsys.readouterr().err


def test_a_budget_below_nothing_is_refused() -> None:
    """The message has the flag, the value and what to give; 0 turns checkpoints off."""
    assert PageFlags(checkpoints=0).budget() == 0
    with pytest.raises(SlamError, match=r"--checkpoints -1 .*give 0"):
        PageFlags(checkpoints=-1).budget()


@pytest.mark.parametrize("minutes", [-1.0, 241.0, float("nan")])
def test_a_length_of_a_stream_that_cannot_be_kept_is_refused(minutes: float) -> None:
    """The message has the flag, the value and the range; 0 keeps nothing."""
    assert (PageFlags().kept_seconds(), PageFlags(look_back=0.0).kept_seconds()) == (LOOK_BACK_S, 0.0)
    with pytest.raises(SlamError, match=r"--look-back .* give 0 to 240"):
        PageFlags(look_back=minutes).kept_seconds()


def test_a_settings_file_may_be_a_pipe() -> None:
    """It is read once: its settings and what it states of the sensors hold, however often they are asked for."""
    end, begin = os.pipe()
    os.write(begin, b"[fusion]\nomega = 0.3\n[sensors]\nimu_delay = 0.1\n")
    os.close(begin)
    flags = setting_flags()(config=Path(f"/dev/fd/{end}"))
    for _ in range(2):
        assert flags.settings().start.fusion.omega == 0.3
        assert source_options(source_flags(), flags).imu_delay == 0.1
    os.close(end)


def test_help_and_defaults_are_those_of_the_packages_behind() -> None:
    """They are written again where the command line is described, which must not wait for these packages."""
    assert PageFlags().checkpoints == BUDGET_MB
    described = repr(get_args(ExportArg)[1])
    assert f"default: {','.join(exporter.name for exporter in chosen())}." in described


def test_without_a_command_the_page_is_served(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """As by `view` without a recording: what is wrong with its address is told."""
    monkeypatch.setenv(TOKEN, "short")
    assert main([]) == MISTAKE
    assert "the token has 5 characters" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--folder", "no/such/folder"], "--folder no/such/folder does not exist"),
        (["--upload-limit", "-1"], "--upload-limit -1 is less than nothing"),
    ],
)
def test_what_the_page_cannot_open_is_named(flags: list[str], words: str, capsys: pytest.CaptureFixture[str]):
    """Before it is served."""
    assert main(["view", *flags]) == MISTAKE
    assert words in capsys.readouterr().err


def test_a_certificate_needs_its_key() -> None:
    """And the other way round; both together prove a name."""
    files = Path("certificate.pem"), Path("key.pem")
    assert PageFlags().proof() is None
    assert PageFlags(certificate=files[0], key=files[1]).proof() == files
    for flags in (PageFlags(certificate=files[0]), PageFlags(key=files[1])):
        with pytest.raises(SlamError, match="give both --certificate and --key"):
            flags.proof()

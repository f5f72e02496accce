"""The command line's flags of a page: its address, who may open it, what it can open and what it leaves."""

import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hectorscope.cli.options import optional
from hectorscope.web.address import Certificate
from slam_core.errors import SlamError

TOKEN = "HECTORSCOPE_TOKEN"
LONGEST_LOOK_BACK = 240  # minutes; the memory for them is bounded too


class TokenError(SlamError):
    """The token cannot be had."""


@dataclass
class AddressFlags:
    """Where a page is served."""

    host: Annotated[str, tyro.conf.arg(help="Address to serve; others than this machine need a token.")] = (
        "127.0.0.1"
    )
    port: Annotated[int, tyro.conf.arg(help="Port to serve.")] = 8080
    token: Annotated[
        str | None, optional(f"Secret that a browser must bring; also from {TOKEN} in the environment.")
    ] = None
    token_file: Annotated[
        Path | None, optional("File with that secret, which the command line would show to everybody here.")
    ] = None

    def secret(self) -> str | None:
        """The token of the flag, the file or the environment, in this order; TokenError if it is of no use."""
        if self.token is not None:
            if self.token_file is not None:
                raise TokenError("--token and --token-file are both given: leave one out")
            return self.token
        return os.environ.get(TOKEN) if self.token_file is None else read_token(self.token_file)


@dataclass
class PageFlags(AddressFlags):
    """Where the page of a run is served, what it can open, and what it leaves."""

    out: Annotated[
        Path | None,
        optional("Folder for the results of `run`: saved by a button of the page, and at the end."),
    ] = None
    folder: Annotated[
        tyro.conf.UseAppendAction[tuple[Path, ...]],
        optional("Folder whose recordings the page can open; give it again for more of them."),
    ] = ()
    certificate: Annotated[
        Path | None, optional("File with a certificate and those of its issuers (PEM): the page comes by https.")
    ] = None
    key: Annotated[Path | None, optional("File with the private key of that certificate (PEM).")] = None
    public_url: Annotated[
        str | None,
        optional("Address at which a reverse proxy offers the page.", metavar="URL"),
    ] = None
    runs: Annotated[
        Path | None, optional("Folder in which the page keeps runs by name, and from which it opens them again.")
    ] = None
    upload_limit: Annotated[
        int, tyro.conf.arg(help="Most MiB of recordings that are dropped onto the page, together; 0 takes none.")
    ] = 512
    checkpoints: Annotated[
        int, tyro.conf.arg(help="Most memory for checkpoints of a recording, in MiB; 0 makes seeks slow.")
    ] = 512

    ahead: Annotated[
        bool,
        tyro.conf.arg(name="pass", help="Run a recording to its end in spare time, ahead of what is shown."),
    ] = True

    classroom: Annotated[
        tyro.conf.FlagCreatePairsOff[bool],
        tyro.conf.arg(name="class", help="Let browsers follow the view of a teacher, whose link is printed too."),
    ] = False

    look_back: Annotated[
        float,
        tyro.conf.arg(help="Minutes of a stream that are kept, to be shown again; 0 for none."),
    ] = 5.0

    def kept_seconds(self) -> float:
        """Seconds of a stream that are kept; SlamError for what is no length of time."""
        if not 0.0 <= self.look_back <= LONGEST_LOOK_BACK:
            raise SlamError(
                f"--look-back {self.look_back:g} is no number of minutes: give 0 to {LONGEST_LOOK_BACK}"
            )
        return 60.0 * self.look_back

    def proof(self) -> Certificate | None:
        """What the server proves its name by; SlamError for a certificate without a key, or a key alone."""
        if self.certificate is not None and self.key is not None:
            return Certificate(self.certificate, self.key)
        if self.certificate is not None or self.key is not None:
            raise SlamError("a certificate and its key belong together: give both --certificate and --key")
        return None

    def budget(self) -> int:
        """MiB of checkpoints; SlamError for less than none."""
        if self.checkpoints < 0:
            raise SlamError(f"--checkpoints {self.checkpoints} is less than nothing: give 0 for none, or more")
        return self.checkpoints

    def uploads(self) -> int:
        """Bytes that may be sent by browsers; SlamError for less than none."""
        if self.upload_limit < 0:
            raise SlamError(f"--upload-limit {self.upload_limit} is less than nothing: give 0 for none, or more")
        return self.upload_limit * 2**20


def read_token(path: Path) -> str:
    """The secret in a file that nobody else may read; TokenError otherwise."""
    try:
        mode, text = path.stat().st_mode, path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise TokenError(f"--token-file {path} cannot be read ({reason}): give a file with the token") from error
    if os.name == "posix" and mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise TokenError(f"--token-file {path} can be read by others: run chmod 600 {path}")
    if not text:
        raise TokenError(f"--token-file {path} is empty: write the token into it")
    return text


AddressArgs = Annotated[AddressFlags, tyro.conf.arg(name="")]
PageArgs = Annotated[PageFlags, tyro.conf.arg(name="")]

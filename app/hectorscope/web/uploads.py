"""Receives recordings that are dropped onto the page, piece by piece, into a folder that ends with the program."""

import asyncio
import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from hectorscope.common.terminal import printable
from hectorscope.sources import suffix_of
from slam_core.errors import SlamError

LONGEST_NAME = 120  # characters
LONGEST_HEAD = 2000  # characters of the first message
IDLE_S = 30.0  # without a piece for so long, the browser has gone
SPARE = 256 * 2**20  # bytes of the disk that are left free
MEBIBYTE = 2**20


class UploadError(SlamError):
    """A recording is not taken: why, and what to do instead."""


class Peer(Protocol):
    """The browser's end of the connection."""

    async def piece(self) -> str | bytes:
        """The next message, as it came."""

    async def send(self, message: str) -> None:
        """Answer."""


class Uploads:
    """The browser says name and size, sends the bytes, and hears how it ended, each as JSON.

    limit: bytes of all recordings together. arrived: gets each file, and the name that is shown for it, which is a
    label and no part of any path. Belongs to the thread of the server's event loop.
    """

    def __init__(self, limit: int, arrived: Callable[[Path, str], None]) -> None:
        self._limit, self._arrived = limit, arrived
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._taken = self._count = 0

    def close(self) -> None:
        """Remove everything."""
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    async def receive(self, peer: Peer) -> None:
        """One recording."""
        try:
            path, name = await self._store(peer)
        except UploadError as refusal:
            await peer.send(json.dumps({"refused": str(refusal)}))
            return
        self._arrived(path, name)
        await peer.send(json.dumps({"arrived": name}))

    async def _store(self, peer: Peer) -> tuple[Path, str]:
        name, suffix, size = announced(await _piece(peer))
        path = self._room(name, size) / f"{self._count}{suffix}"
        self._count += 1
        self._taken += size
        try:
            await peer.send(json.dumps({"send": size}))
            await _write(peer, path, size)
        except BaseException:  # also a browser that has gone
            path.unlink(missing_ok=True)
            self._taken -= size
            raise
        return path, name

    def _room(self, name: str, size: int) -> Path:
        """The folder; UploadError if there is no room in it."""
        left = self._limit - self._taken
        if size > left:
            raise UploadError(
                f"{name} has {_mebibytes(size)}, and {_mebibytes(left)} of {_mebibytes(self._limit)} are left for"
                " recordings sent by browsers: put it into a folder given by --folder, or raise --upload-limit"
            )
        try:
            self._folder = self._folder or tempfile.TemporaryDirectory(prefix="hectorscope-")
            free = shutil.disk_usage(self._folder.name).free - SPARE
        except OSError as error:
            raise UploadError(f"there is no folder for {name} ({error.strerror}): set TMPDIR to one") from error
        if size > free:
            raise UploadError(
                f"{name} has {_mebibytes(size)}, and the disk has no room: set TMPDIR to another one"
            )
        return Path(self._folder.name)


def announced(head: str | bytes) -> tuple[str, str, int]:
    """Label, suffix and size of what will be sent; UploadError if it is no recording or makes no sense."""
    try:
        told: Any = json.loads(head) if isinstance(head, str) and len(head) <= LONGEST_HEAD else None
    except (ValueError, RecursionError):
        told = None
    match told:
        case {"name": str(given), "size": int(size)} if size >= 0 and not isinstance(told["size"], bool):
            name = printable(given.replace("\\", "/").rsplit("/", 1)[-1])[-LONGEST_NAME:]
        case _:
            raise UploadError("the browser did not say what it sends: load the page again")
    suffix = suffix_of(name)
    if not suffix:
        raise UploadError(f"{name} is no recording by its name: drop a .bag, .mcap, .db3, .clf, .log or .dat file")
    if not size:
        raise UploadError(f"{name} is empty: record it again")
    return name, suffix, size


async def _write(peer: Peer, path: Path, size: int) -> None:
    """So many bytes, not one more; UploadError if they do not come, or the disk refuses them."""
    try:
        with path.open("xb") as file:
            while file.tell() < size:
                piece = await _piece(peer)
                if not isinstance(piece, bytes) or file.tell() + len(piece) > size or not piece:
                    raise UploadError("the browser sent something else than it had said: drop the file again")
                file.write(piece)
    except OSError as error:
        raise UploadError(
            f"the recording cannot be kept ({error.strerror}): set TMPDIR to another disk"
        ) from error


async def _piece(peer: Peer) -> str | bytes:
    try:
        return await asyncio.wait_for(peer.piece(), IDLE_S)
    except TimeoutError as error:
        raise UploadError(f"nothing came for {IDLE_S:.0f} s: drop the file again") from error


def _mebibytes(size: int) -> str:
    return f"{max(0, size) / MEBIBYTE:.1f} MiB"

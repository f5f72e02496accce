"""Receives recordings that are dropped onto the page, piece by piece, into a folder that ends with the program.

Of a rosbag2 folder the files with messages are taken, and get names of ours. Its metadata.yaml is not: it names
files, and so could make us read others of this disk.
"""

import asyncio
import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from hectorscope.common.terminal import printable
from hectorscope.sources import suffix_of
from slam_core.errors import SlamError

LONGEST_NAME = 120  # characters
LONGEST_HEAD = 40_000  # characters of the first message
MOST_PARTS = 200  # files of a folder
IDLE_S = 30.0  # without a piece for so long, the browser has gone
SPARE = 256 * 2**20  # bytes of the disk that are left free
MEBIBYTE = 2**20


class UploadError(SlamError):
    """A recording is not taken: why, and what to do instead."""


class Announced(NamedTuple):
    """What will be sent: a label, suffix and bytes of each file; is_folder: they are parts of a recording."""

    name: str
    parts: tuple[tuple[str, int], ...]
    is_folder: bool = False

    @property
    def size(self) -> int:
        """Bytes of all of it."""
        return sum(size for _, size in self.parts)


class Peer(Protocol):
    """The browser's end of the connection."""

    async def piece(self) -> str | bytes:
        """The next message, as it came."""

    async def send(self, message: str) -> None:
        """Answer."""


class Uploads:
    """The browser says names and sizes, sends the bytes, and hears how it ended, each as JSON.

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
        told = announced(await _piece(peer))
        place = self._room(told.name, told.size) / str(self._count)
        path = place if told.is_folder else place.with_name(place.name + told.parts[0][0])
        self._count += 1
        self._taken += told.size
        try:
            await peer.send(json.dumps({"send": told.size}))
            for number, (suffix, size) in enumerate(told.parts):
                await _write(peer, path / f"sent_{number:04d}{suffix}" if told.is_folder else path, size)
        except BaseException:  # also a browser that has gone
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
            self._taken -= told.size
            raise
        return path, told.name

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


def announced(head: str | bytes) -> Announced:
    """What a browser will send; UploadError if it is no recording or makes no sense."""
    try:
        told: Any = json.loads(head) if isinstance(head, str) and len(head) <= LONGEST_HEAD else None
    except (ValueError, RecursionError):
        told = None
    match told:
        case {"name": str(name), "size": size}:
            return Announced(_label(name), (_part(name, size, SINGLE),))
        case {"name": str(name), "files": [_, *_] as files} if len(files) <= MOST_PARTS:
            parts = tuple(
                _part(each[0], each[1], PARTS) for each in files if isinstance(each, list) and len(each) == 2
            )
            if len(parts) == len(files):
                return Announced(_label(name), parts, is_folder=True)
    raise UploadError("the browser did not say what it sends: load the page again")


SINGLE = "drop a .bag, .mcap, .db3, .clf, .log or .dat file, or a rosbag2 folder"
PARTS = "drop a folder with .mcap or .db3 files"


def _label(name: str) -> str:
    return printable(name.replace("\\", "/").rsplit("/", 1)[-1])[-LONGEST_NAME:]


def _part(name: Any, size: Any, remedy: str) -> tuple[str, int]:
    """Suffix and bytes of a file."""
    if not isinstance(name, str) or type(size) is not int or size < 0:
        raise UploadError("the browser did not say what it sends: load the page again")
    label, suffix = _label(name), suffix_of(name)
    if not suffix or (remedy == PARTS and suffix not in (".mcap", ".db3")):
        raise UploadError(f"{label} is no recording by its name: {remedy}")
    if not size:
        raise UploadError(f"{label} is empty: record it again")
    return suffix, size


async def _write(peer: Peer, path: Path, size: int) -> None:
    """So many bytes exactly, in a folder that may be new; UploadError if they do not come, or find no room."""
    try:
        path.parent.mkdir(exist_ok=True)
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

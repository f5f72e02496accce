"""Records a live stream as it came: MCAP files of bounded length and size, written by a thread of their own."""

import os
import re
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from hectorscope.common.paths import exists
from hectorscope.inputs import Message
from slam_core.errors import SlamError

PART = re.compile(r"stream_(\d{4,})\.mcap")
PART_BYTES, PART_S = 256 * 2**20, 600.0
CHUNK = 16 * 1024  # bytes: of a slow laser some seconds
FLUSH_S, SYNC_S = 0.5, 5.0  # to the system, which outlives us; to the disk, which outlives the system
AGAIN_S = 5.0  # seconds from a failure to the next file
MOST_WAITING = 64 * 2**20  # bytes of messages, while the disk is busy
SCHEMAS = {("cdr", "msg"): "ros2msg", ("ros1", "msg"): "ros1msg", ("cdr", "idl"): "ros2idl"}


class RecordError(SlamError):
    """A stream cannot be recorded there."""


def parts(folder: Path) -> list[Path]:
    """The files of a recording, in their order."""
    found = ((PART.fullmatch(path.name), path) for path in folder.glob("stream_*.mcap"))
    return [path for _, path in sorted((int(name[1]), path) for name, path in found if name)]


class StreamRecorder:
    """A `MessageListener` that keeps every message in `folder`, until `close`.

    What goes wrong there never stops the stream. Times are those of the other side; one that went back is recorded
    as the last, so that files keep the order of arrival. part_bytes, part_s: the largest and the longest file.
    again_s: seconds from a failure to the next file. written: bytes so far. failed: whether the last attempt to
    write failed.
    """

    def __init__(
        self,
        folder: Path,
        *,
        part_bytes: int = PART_BYTES,
        part_s: float = PART_S,
        again_s: float = AGAIN_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """RecordError if the folder cannot be had. One that holds parts already gets more of them."""
        self.folder, self.warning, self.written, self.failed = folder, "", 0, False
        self._part_bytes, self._part_s, self._again_s, self._clock = part_bytes, part_s, again_s, clock
        self._waiting: deque[Message] = deque()
        self._bytes_waiting = 0
        self._lock = threading.Lock()
        self._wake, self._closing = threading.Event(), False
        self._last_ns = 0
        self._part: _Part | None = None
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            names = [PART.fullmatch(path.name) for path in parts(folder)]
            self._number = max((int(name[1]) for name in names if name), default=0)
            self._begin()
        except OSError as error:
            raise RecordError(f"{folder} cannot be written ({error.strerror}): choose another folder") from error
        self._thread = threading.Thread(target=self._run, name="record", daemon=True)
        self._thread.start()

    def take(self, message: Message) -> None:
        """Keep one more message; returns at once. One that finds no room is given up, and that is told."""
        with self._lock:
            if self._closing:
                return
            if self._bytes_waiting + len(message.data) > MOST_WAITING:
                self.warning = f"{self.folder} is too slow: messages of the stream are missing in the recording"
                return
            self._waiting.append(message)
            self._bytes_waiting += len(message.data)

    def close(self) -> None:
        """Write what waits, and end the last file; waits for it."""
        with self._lock:
            self._closing = True
        self._wake.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._closing:
            self._wake.wait(self._again_s if self.failed else FLUSH_S)
            self._try(self._write)
        self._try(self._write)
        self._try(self._end)

    def _try(self, act: Callable[[], None]) -> None:
        """Whatever goes wrong ends the file, and is told: the next attempt begins another file."""
        try:
            act()
        except Exception as error:  # a full disk, or a message that the format cannot hold
            reason = getattr(error, "strerror", None) or f"{type(error).__name__}: {error}"
            remedy = "make room, " if isinstance(error, OSError) else ""
            self.failed = True
            self.warning = (
                f"the stream is not recorded at this moment ({self.folder}: {reason}): {remedy}it is tried again"
            )
            self._drop()

    def _drop(self) -> None:
        """Let go of a file that cannot be written on; what it holds stays."""
        part, self._part = self._part, None
        if part is not None:
            with suppress(OSError, ValueError):
                part.drop()

    def _write(self) -> None:
        with self._lock:
            messages, self._waiting, self._bytes_waiting = self._waiting, deque(), 0
        for message in messages:
            part = self._part
            if part is None or part.size > self._part_bytes or self._clock() - part.begun > self._part_s:
                self._end()
                part = self._begin()
            self._last_ns = max(self._last_ns, message.received_ns)
            part.write(message, self._last_ns)
        more = self._part.flush(self._clock()) if self._part is not None else 0
        self.written += more
        if more:
            self.failed, self.warning = False, ""

    def _begin(self) -> "_Part":
        self._number += 1
        while exists(path := self.folder / f"stream_{self._number:04}.mcap"):
            self._number += 1
        self._part = _Part(path, self._clock())
        return self._part

    def _end(self) -> None:
        if self._part is not None:
            self._part.end()
            self._part = None


class _Part:
    """One file. What was flushed can be read whatever becomes of the rest."""

    def __init__(self, path: Path, now: float) -> None:
        from mcap.writer import CompressionType, Writer  # noqa: PLC0415

        self.file: BinaryIO = path.open("xb")
        self.begun = self._synced = now
        self._flushed = 0
        self._writer = Writer(self.file, chunk_size=CHUNK, compression=CompressionType.ZSTD)
        self._channels: dict[tuple[str, ...], int] = {}

    @property
    def size(self) -> int:
        """Bytes so far."""
        return self.file.tell()

    def write(self, message: Message, log_ns: int) -> None:
        """Append a message."""
        key = message[:5]
        channel = self._channels.get(key) or self._channel(key)
        self._writer.add_message(channel, log_ns, message.data, message.received_ns)

    def _channel(self, key: tuple[str, ...]) -> int:
        topic, encoding, msgtype, definition, form = key
        if not self._channels:
            self._writer.start("ros2" if encoding == "cdr" else "ros1", "hectorscope")
        schema = self._writer.register_schema(
            msgtype, SCHEMAS.get((encoding, form), f"{encoding}{form}"), definition.encode()
        )
        self._channels[key] = self._writer.register_channel(topic, encoding, schema)
        return self._channels[key]

    def flush(self, now: float) -> int:
        """Hand to the system what is there, now and then to the disk; how many bytes more that is."""
        self.file.flush()
        if now - self._synced >= SYNC_S:
            os.fsync(self.file.fileno())
            self._synced = now
        before, self._flushed = self._flushed, self.size
        return self._flushed - before

    def end(self) -> None:
        """Close the file; one without a message is removed."""
        if self._channels:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self.file.flush()
            os.fsync(self.file.fileno())
        self.file.close()
        if not self._channels:
            Path(self.file.name).unlink()

    def drop(self) -> None:
        """Close the file as it is; one without a byte is removed."""
        with suppress(OSError):  # what was not written still is not
            self.file.close()
        path = Path(self.file.name)
        if not path.stat().st_size:
            path.unlink()

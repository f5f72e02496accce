"""An MCAP while it is written: on the standard input, or a file that grows."""

import os
import select
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from io import RawIOBase
from pathlib import Path
from typing import Any

from mcap.exceptions import EndOfFile, McapError
from mcap.records import Channel, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader

from hectorscope.common.paths import absence
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.ros.decode import ros2_name
from hectorscope.sources import stream
from hectorscope.sources._live import LiveSource
from hectorscope.sources._mcap_scan import FORMS, records
from hectorscope.sources._offers import Event, Offer, Payload

STDIN, FILE = "-", "file://PATH"
LARGEST_RECORD = 128 * 2**20  # bytes; a chunk has some megabytes
LOOK_S = 0.02  # between two looks whether a file has grown, or whether to stop
SILENT_S = 2.0  # without anything new, this is told


class Growing(RawIOBase):
    """Bytes of a file descriptor as they come. is_file: its end is only the end so far."""

    def __init__(self, descriptor: int, *, is_file: bool) -> None:
        self._descriptor, self._is_file = descriptor, is_file
        self._stopped = threading.Event()
        self.heard = time.monotonic()

    def readable(self) -> bool:
        """It can be read."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Wait for the next bytes; 0 at the end, or once it is stopped."""
        while not self._stopped.is_set():
            if self._is_file or select.select([self._descriptor], [], [], LOOK_S)[0]:
                count = os.readv(self._descriptor, [buffer])
                if count or not self._is_file:
                    self.heard = time.monotonic()
                    return count
                self._stopped.wait(LOOK_S)
        return 0

    def stop(self) -> None:
        """End the waiting, from any thread."""
        self._stopped.set()


def _opened(path: Path) -> int:
    """Its descriptor; SourceError for one that cannot be read, as a socket."""
    try:
        return os.open(path, os.O_RDONLY)
    except OSError as error:
        raise SourceError(
            f"{path} cannot be read ({error.strerror}): give an .mcap that is being written"
        ) from error


class McapWire:
    """The records of one stream; only what is subscribed to is handed on."""

    def __init__(self, uri: str) -> None:
        """SourceError if there is no such file."""
        if uri == STDIN:
            self._name, descriptor = "the standard input", sys.stdin.fileno()
        else:
            path = Path(uri.partition("://")[2])
            if why := absence(path):
                raise SourceError(f"{path} {why}: give an .mcap that is being written")
            self._name, descriptor = str(path), _opened(path)
        self._input = Growing(descriptor, is_file=uri != STDIN)
        self._wanted: set[int] = set()
        self._ended = False

    @property
    def status(self) -> str:
        """Why nothing flows right now; empty while it does."""
        if self._ended:
            return f"{self._name} has ended"
        silent = time.monotonic() - self._input.heard > SILENT_S
        return f"nothing new comes from {self._name}: start what writes it" if silent else ""

    @property
    def round_trip_s(self) -> float | None:
        """What comes may have been recorded long ago."""
        return None

    def connections(self) -> Iterator[Iterator[Sequence[Event]]]:
        """One, from the beginning to the end of the MCAP."""
        yield self._events()
        self._ended = True

    def _events(self) -> Iterator[Sequence[Event]]:
        schemas: dict[int, Schema] = {}
        try:
            for record in records(StreamReader(self._input, emit_chunks=True, record_size_limit=LARGEST_RECORD)):
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif event := self._event(record, schemas):
                    yield [event]
        except EndOfFile:
            return
        except McapError as error:
            raise SourceError(f"{self._name} is no MCAP or is damaged ({error}): write it again") from error

    def _event(self, record: McapRecord, schemas: dict[int, Schema]) -> Event | None:
        if isinstance(record, Message) and record.channel_id in self._wanted:
            return Payload(record.channel_id, record.log_time, record.data)
        if isinstance(record, Channel) and (schema := schemas.get(record.schema_id)):
            form = FORMS.get(schema.encoding)
            text = schema.data.decode(errors="replace") if form else ""
            name = ros2_name(schema.name)
            return Offer(record.id, record.topic, record.message_encoding, name, text, form or "msg")
        return None

    def subscribe(self, offers: Sequence[Offer]) -> None:
        """Hand on the messages of these channels."""
        self._wanted |= {offer.id for offer in offers}

    def close(self) -> None:
        """Stop reading."""
        self._input.stop()


def _open(uri: str, options: SourceOptions) -> LiveSource:
    return LiveSource(uri, options, McapWire(uri))


SOURCE = stream(_open, STDIN, FILE)

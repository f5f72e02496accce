"""The thread that reads a source, so that slow reading and slow matching do not wait for each other."""

import threading
from collections.abc import Iterator
from itertools import islice

from hectorscope.inputs import Item, Seekable, Source, SourceError
from hectorscope.run.checkpoints import Place
from hectorscope.session.stream_queue import StreamQueue
from slam_core.errors import SlamError
from slam_core.measurements import LaserScan

APART = 50  # scans from one place to the next: some 50 ms of work


class Feeder:
    """One pass over a source's items, from after the first `skip` ones or a place, through a bounded queue."""

    def __init__(self, source: Source, start: int | Place = 0) -> None:
        self._source, self._start = source, start
        self._places: dict[int, Place] = {}
        self._queue = StreamQueue(live=source.live)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._read, name=f"source {source.name}", daemon=True)
        self._thread.start()

    def _read(self) -> None:
        try:
            for item in self._items():
                if not self._queue.put(item):
                    break
        except Exception as error:  # whatever it is, the engine reports it and lives on
            self._error = error
        self._queue.finish()

    def _items(self) -> Iterator[Item]:
        """The items; places are noted before the engine can get what leads to them."""
        source, start, scans = self._source, self._start, 0
        if isinstance(start, Place):
            assert isinstance(source, Seekable)
            taken, items = start.taken, source.items_from(start.state)
        else:
            taken, items = start, islice(source.items(), start, None)
        for item in items:
            taken += 1
            scans += isinstance(item, LaserScan)
            if scans == APART and not source.live and isinstance(source, Seekable):
                scans, state = 0, source.place()
                if state is not None:
                    self._places[taken] = Place(taken, state)
            yield item

    def place(self, taken: int) -> Place | None:
        """The place behind so many items, if it was noted; once."""
        return self._places.pop(taken, None)

    @property
    def reading(self) -> bool:
        """Whether the source may still give something."""
        return self._thread.is_alive()

    @property
    def dropped(self) -> int:
        """Scans given up because the pipeline was too slow for a live stream."""
        return self._queue.dropped

    @property
    def done(self) -> bool:
        """Whether every item was handed out."""
        return self._queue.done

    def get(self, timeout: float) -> Item | None:
        """The next item, or None after `timeout` seconds."""
        return self._queue.get(timeout)

    def check(self) -> None:
        """Raise what ended the reading, if it was an error: a SourceError that names the source."""
        if self._error is None:
            return
        if isinstance(self._error, SlamError):
            raise self._error
        text = f"{type(self._error).__name__}: {self._error}"
        raise SourceError(
            f"{self._source.name} cannot be read on ({text}): check the input and restart"
        ) from self._error

    def close(self) -> None:
        """Stop reading; waits for the thread. A live source must be closed before, or it may be waiting itself."""
        self._queue.close()
        self._thread.join(timeout=5.0)

"""The thread that reads a source, so that slow reading and slow matching do not wait for each other."""

import threading
from itertools import islice

from hectorscope.inputs import Item, Source, SourceError
from hectorscope.session.stream_queue import StreamQueue
from slam_core.errors import SlamError


class Feeder:
    """One pass over a source's items, from after the first `skip` ones, through a bounded queue."""

    def __init__(self, source: Source, skip: int = 0) -> None:
        self._source, self._skip = source, skip
        self._queue = StreamQueue(live=source.live)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._read, name=f"source {source.name}", daemon=True)
        self._thread.start()

    def _read(self) -> None:
        try:
            for item in islice(self._source.items(), self._skip, None):
                if not self._queue.put(item):
                    break
        except Exception as error:  # whatever it is, the engine reports it and lives on
            self._error = error
        self._queue.finish()

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

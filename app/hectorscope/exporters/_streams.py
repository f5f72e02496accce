"""The formats that are written while the run goes on, and the drafts of others."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from hectorscope.exporters._exporter import Exporter, Stream
from hectorscope.exporters._files import unfinished
from hectorscope.run.pipeline import Pipeline
from slam_core.results import StepResult


class Streams:
    """Those of `formats` that are streams, opened with the first result.

    One that fails is given up and costs no other its files. missing: reason -> the files that will not be there.
    Drafts are removed in the end unless something failed.
    """

    def __init__(self, formats: Iterable[Exporter], folder: Path) -> None:
        self.missing: defaultdict[str, list[str]] = defaultdict(list)
        formats = list(formats)
        self._formats = {exporter: exporter.stream for exporter in formats if exporter.stream is not None}
        self._drafted = [exporter for exporter in formats if exporter.drafts is not None]
        self._drafts: list[Stream] = []
        self._folder = folder
        self._open: dict[Exporter, Stream] | None = None

    def __enter__(self) -> Self:
        """Nothing is opened yet."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave what there is, under a name that says that it is not finished."""
        for stream in (*(self._open or {}).values(), *self._drafts):
            with suppress(OSError):
                stream.close()
        for exporter in self._drafted if kind is None else ():
            for name in exporter.files:
                unfinished(self._folder / name).unlink(missing_ok=True)

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """A scan gave a result."""
        if self._open is None:
            self._open = {}
            for exporter, stream in self._formats.items():
                with self._guarded(exporter):
                    self._open[exporter] = stream(self._folder)
            with suppress(OSError):
                self._drafts = [
                    draft for each in self._drafted if each.drafts for draft in each.drafts(self._folder)
                ]
        for exporter, opened in list(self._open.items()):
            with self._guarded(exporter):
                opened.add(pipeline, result)
        with suppress(OSError):  # the file itself is written in the end, and says what is wrong
            for draft in self._drafts:
                draft.add(pipeline, result)

    def finish(self, pipeline: Pipeline) -> None:
        """The run is at its end: the files get their names."""
        for exporter, opened in list((self._open or {}).items()):
            with self._guarded(exporter):
                opened.finish(pipeline)
        with suppress(OSError):
            for draft in self._drafts:
                draft.finish(pipeline)

    @contextmanager
    def _guarded(self, exporter: Exporter) -> Iterator[None]:
        try:
            yield
        except Exception as error:  # what one format chokes on must not cost the others
            self.missing[reason(error)] += exporter.files
            if self._open and (opened := self._open.pop(exporter, None)):
                with suppress(OSError):
                    opened.close()


def reason(error: Exception) -> str:
    """Why a file cannot be written, in a few words."""
    if isinstance(error, OSError):
        return error.strerror or str(error)
    return f"{type(error).__name__}: {error}"

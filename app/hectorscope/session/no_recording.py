"""What a session begins with while nothing is open yet."""

from collections.abc import Iterator

from hectorscope.inputs import Item, SourceReport


class NoRecording:
    """A source of nothing."""

    name = ""
    live = False
    span_ns = None
    report = SourceReport()

    def items(self) -> Iterator[Item]:
        """None."""
        return iter(())

    def close(self) -> None:
        """Nothing to let go of."""

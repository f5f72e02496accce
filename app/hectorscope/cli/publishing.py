"""The results of a run at the addresses that the command line names."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from hectorscope.inputs import Source

if TYPE_CHECKING:
    from hectorscope.run.headless import Observer  # takes long: loads the compiler


@contextmanager
def published(addresses: Sequence[str], source: Source | None) -> Iterator["Observer"]:
    """An observer that publishes what `source` gives; PublishError for an address that cannot be served."""
    if not addresses or source is None:
        yield lambda _pipeline, _result: None
        return
    from hectorscope.publishing import open_bus  # noqa: PLC0415
    from hectorscope.publishing.publishing import Publishing  # noqa: PLC0415

    with ExitStack() as opened:
        buses = []
        for address in addresses:
            buses.append(open_bus(address))
            opened.callback(buses[-1].close)
        publishing = Publishing(buses, source)
        opened.callback(publishing.close)
        yield publishing.add

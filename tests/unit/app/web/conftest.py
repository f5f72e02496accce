"""A viser server behind its gate, once for all tests that only need one to exist."""

from collections.abc import Iterator

import pytest
import viser

from app.web.gate import Gate
from app.web.private import open_server, stop_server
from app.web.server import listen


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    made = open_server(listen("127.0.0.1", 0), Gate({}))
    yield made
    stop_server(made)

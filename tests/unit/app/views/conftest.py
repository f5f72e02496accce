"""A stage without browsers."""

from collections.abc import Iterator

import pytest

from app.web.gate import Gate
from app.web.private import open_server, stop_server
from app.web.server import listen
from app.web.stage import Stage


@pytest.fixture
def stage() -> Iterator[Stage]:
    server = open_server(listen("127.0.0.1", 0), Gate({}))
    yield Stage(server, lambda command: None)
    stop_server(server)

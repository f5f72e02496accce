"""A viser server and a scene without browsers."""

from collections.abc import Iterator

import pytest
import viser

from hectorscope.page.scene import Scene
from hectorscope.web.access_control import AccessControl
from hectorscope.web.address import listen
from hectorscope.web.guarded_server import open_server, stop_server


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    """Once for all tests of a module that only need one to exist."""
    made = open_server(listen("127.0.0.1", 0), AccessControl({}))
    yield made
    stop_server(made)


@pytest.fixture
def scene() -> Iterator[Scene]:
    """With a server of its own."""
    made = open_server(listen("127.0.0.1", 0), AccessControl({}))
    yield Scene(made, lambda command: None)
    stop_server(made)

"""A browser that sets a control, as viser hears and reports it."""

import asyncio
from concurrent.futures import Executor
from typing import Any
from unittest.mock import create_autospec, patch

from viser import ClientHandle
from viser._messages import GuiUpdateMessage

CLIENT = 7


def by_hand(handle: Any, value: Any) -> None:
    """All of it that viser does before it hears the next message; its threads are busy."""
    gui = handle._impl.gui_api
    message = GuiUpdateMessage(handle._impl.uuid, {"value": value})
    with (
        patch.object(gui, "_resolve_client", return_value=create_autospec(ClientHandle)),
        patch.object(gui, "_thread_executor", create_autospec(Executor)),
    ):
        asyncio.run(gui._handle_gui_updates(CLIENT, message))

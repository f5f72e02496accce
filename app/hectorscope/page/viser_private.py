"""The private parts of viser that the page's scene and GUI use (those of its server: `web.guarded_server`).

viser is pinned exactly; tests pin each of these uses. Scripts fail soft: without them, and without those in
static/, the page works in the dark theme with blurred cells and viser's own camera, but has no plots.
"""

import contextlib
import logging
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import viser
from viser import _icons, _messages

log = logging.getLogger(__name__)

INDEX = Path(viser.__file__).parent / "client" / "build" / "index.html"


@contextlib.contextmanager
def icons_at_hand() -> Iterator[None]:
    """Hold viser's archive of icons open: for each icon it would read the names of all the thousands in it."""
    names = vars(_icons)
    original = names["zipfile"]
    with zipfile.ZipFile(_icons.ICONS_DIR / "tabler-icons.zip") as archive:
        names["zipfile"] = SimpleNamespace(ZipFile=lambda _: contextlib.nullcontext(archive))
        try:
            yield
        finally:
            names["zipfile"] = original


def input_control(server: viser.ViserServer, uuid: str) -> Any:
    """The control of the shared GUI with this uuid, or None."""
    return server.gui._gui_input_handle_from_uuid.get(uuid)


def uuid_of(control: Any) -> str:
    """How a control of the shared GUI is called in messages; `input_control` finds it by that."""
    uuid: str = control._impl.uuid
    return uuid


def keep_to_server(control: Any) -> None:
    """What one browser gives the control is not sent to the others, as viser does by itself."""
    control._impl.sync_cb = None


def run_script(client: viser.ClientHandle, source: str) -> None:
    """Run JavaScript in one browser, now; nothing stays behind in the buffer that joiners are replayed.

    A browser that has gone runs nothing; viser would warn of it.
    """
    try:
        connection = client._websock_connection
        if not connection.get_message_buffer().done:
            connection.queue_message(_messages.RunJavascriptMessage(source=source))
    except AttributeError as error:
        log.warning("this viser cannot run scripts in the page: %s", error)


def unsent(client: viser.ClientHandle) -> int:
    """Characters of the scripts that wait for a browser, which grow while it does not read; viser drops none."""
    try:
        buffer = client._websock_connection.get_message_buffer()
        with buffer.buffer_lock:
            return sum(len(getattr(message, "source", "")) for message in buffer.message_from_id.values())
    except AttributeError as error:
        log.warning("this viser does not tell what waits for a browser: %s", error)
        return 0


def hang_up(client: viser.ClientHandle) -> None:
    """End the connection of one browser at once: one that does not read would not hear a farewell."""
    server = client._viser_server._websock_server
    connection, loop = server._live_connections.get(client.client_id), server._background_event_loop
    if connection is not None and loop is not None:
        loop.call_soon_threadsafe(connection.transport.abort)


@contextlib.contextmanager
def one_message(server: viser.ViserServer) -> Iterator[None]:
    """What is sent to all browsers meanwhile reaches them as one message, at once.

    As `atomic` and then `flush`, but the thread of the server is woken once, and not if nothing waits. What waits
    may be from an earlier turn: a thread that woke during the next one found it closed.
    """
    buffer = server._websock_server._broadcast_buffer
    buffer.atomic_start()
    try:
        yield
    finally:
        with buffer.buffer_lock:
            buffer.atomic_counter -= 1
        newest = buffer.message_counter - 1
        if any(sent < newest for sent in list(buffer.generator_cursors.values())):
            with contextlib.suppress(RuntimeError):  # the server has stopped
                buffer.event_loop.call_soon_threadsafe(_wake, buffer)


def _wake(buffer: Any) -> None:
    buffer.message_event.set()
    buffer.flush_event.set()


def move(node: Any, position: Iterable[float], wxyz: Iterable[float] | None = None) -> None:
    """Put a node at a position (3), in metres, and turn it: by assignment, viser takes several times as long."""
    state = node._impl
    kinds: Any = (_messages.SetPositionMessage, _messages.SetOrientationMessage)
    for kind, known, wanted in zip(kinds, (state.position, state.wxyz), (position, wxyz), strict=True):
        values = None if wanted is None else tuple(map(float, wanted))
        if values is not None and values != tuple(known.tolist()):
            known[:] = values
            state.api._queue_scene_message(kind(state.name, values))


def resize(node: Any, scale: tuple[float, float, float]) -> None:
    """Scale a node along its axes, as `move` moves it."""
    if scale != node._impl.props.scale:
        node._impl.props.scale = scale
        node._queue_update("scale", scale)


def set_png(image: viser.ImageHandle, png: bytes) -> None:
    """Give an image node bytes that are encoded already, instead of pixels that viser would encode slowly."""
    image._format, image._data = "png", png

"""The private parts of viser that the page leans on are where they were."""

import asyncio
import zipfile
from collections.abc import Callable
from typing import Any

import msgspec.msgpack
import numpy as np
import pytest
import viser
import websockets
from viser import _icons
from websockets.asyncio.client import ClientConnection, connect

from hectorscope.page import viser_private as private
from hectorscope.page.palette_png import encode
from tests.live.measurements import wait_for

CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": [1, 0, 0, 0], "position": [0, 0, 0], "fov": 1, "near": 0.1, "far": 10,
    "image_height": 1, "image_width": 1, "look_at": [1, 0, 0], "up_direction": [0, 0, 1],
}  # fmt: skip


def talk(server: viser.ViserServer, *messages: Any, origin: str | None = None) -> list[bytes]:
    """Connect as a browser does, say `messages`, and return what comes within half a second."""

    async def session() -> list[bytes]:
        address = f"ws://127.0.0.1:{server.get_port()}"
        protocol = f"viser-v{viser.__version__}"
        async with connect(address, subprotocols=[protocol], origin=origin) as socket:  # type: ignore[list-item, arg-type]
            for message in messages:
                await socket.send(msgspec.msgpack.encode(message))
            return await heard(socket)

    return asyncio.run(session())


async def heard(socket: ClientConnection) -> list[bytes]:
    found: list[bytes] = []
    with_timeout: Callable[[], Any] = lambda: asyncio.wait_for(socket.recv(), 0.5)  # noqa: E731
    try:
        while True:
            found.append(await with_timeout())
    except TimeoutError:
        return found


def test_values_out_of_range_arrive_clamped(server: viser.ViserServer) -> None:
    """A client that speaks viser's protocol moves a slider to its end and no further."""
    slider = server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.3)
    uuid = slider._impl.uuid
    talk(server, CAMERA, {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": 1e9}})
    assert slider.value == 1.0


def test_a_tunnel_is_never_opened(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """The request for a public address is dropped before viser sees it."""
    asked: list[bool] = []
    monkeypatch.setattr(server, "request_share_url", lambda: asked.append(True))
    talk(server, {"type": "ShareUrlRequest"}, b"\xc1 not a message")
    assert not asked


def test_another_site_gets_no_socket(server: viser.ViserServer) -> None:
    """A handshake with a foreign Origin is answered by 403."""
    with pytest.raises(websockets.InvalidStatus) as refusal:
        talk(server, origin="http://evil.example")
    assert refusal.value.response.status_code == 403


def test_scripts_reach_a_browser_once(server: viser.ViserServer) -> None:
    """A script goes to those who are connected; who comes later is not replayed it."""
    seen: list[viser.ClientHandle] = []
    server.on_client_connect(seen.append)
    server.on_client_connect(lambda client: private.run_script(client, "marker()"))
    assert b"".join(talk(server, CAMERA))
    assert seen
    assert not any("marker" in str(m) for m in server._websock_server._broadcast_buffer.message_from_id.values())


@pytest.mark.filterwarnings("error")
def test_a_script_for_a_browser_that_has_gone_is_no_warning(server: viser.ViserServer) -> None:
    """Browsers leave at any time; the terminal of an operator says nothing of it."""
    seen: list[viser.ClientHandle] = []
    server.on_client_connect(seen.append)
    talk(server, CAMERA)
    wait_for(lambda: seen[0]._websock_connection.get_message_buffer().done)
    private.run_script(seen[0], "marker()")


def test_images_take_encoded_bytes(server: viser.ViserServer) -> None:
    """Bytes given to an image node are what viser sends."""
    image = server.scene.add_image("/image", np.zeros((1, 1, 4), np.uint8), 1.0, 1.0, format="png")
    png = encode(np.ones((2, 2), np.uint8), ((0, 0, 0),) * 3, (0, 255, 255))
    private.set_png(image, png)
    assert (image._impl.props._data, image._impl.props._format) == (png, "png")


def test_a_node_is_moved_and_scaled_as_by_assignment(server: viser.ViserServer) -> None:
    """The same messages as viser makes, and none where nothing changes."""
    here, turned, scale = (1.0, 2.0, 3.0), (0.6, 0.0, 0.0, 0.8), (2.0, 3.0, 1.0)
    buffer = server._websock_server._broadcast_buffer

    def sent(act: Callable[[Any], None], name: str) -> list[dict[str, Any]]:
        node, begun = server.scene.add_icosphere(name), buffer.message_counter
        act(node)
        act(node)
        messages = [message for key, message in buffer.message_from_id.items() if key >= begun]
        assert (node.position.tolist(), node.wxyz.tolist(), node.scale) == (list(here), list(turned), scale)
        return [message.as_serializable_dict([]) | {"name": ""} for message in messages]

    def assign(node: Any) -> None:
        node.position, node.wxyz, node.scale = np.array(here), turned, scale

    def move(node: Any) -> None:
        private.move(node, np.array(here), turned)
        private.resize(node, scale)

    assert sent(move, "/moved") == sent(assign, "/assigned")


def test_what_is_sent_in_one_turn_is_one_message(server: viser.ViserServer) -> None:
    """Two nodes that move reach a browser together, at once; the server is woken once, and not for nothing."""
    nodes = [server.scene.add_frame(name) for name in ("/one", "/other")]
    buffer, woken = server._websock_server._broadcast_buffer, []
    loop = buffer.event_loop
    wake = loop.call_soon_threadsafe

    async def session() -> list[bytes]:
        address, protocol = f"ws://127.0.0.1:{server.get_port()}", f"viser-v{viser.__version__}"
        async with connect(address, subprotocols=[protocol]) as socket:  # type: ignore[list-item]
            await socket.send(msgspec.msgpack.encode(CAMERA))
            await heard(socket)
            loop.call_soon_threadsafe = lambda *args: woken.append(args) or wake(*args)
            messages = []
            for place in (1.0, 1.0):
                with private.one_message(server):
                    for node in nodes:
                        private.move(node, (place, 0.0, 0.0))
                messages += await heard(socket)
            loop.call_soon_threadsafe = wake
            return messages

    assert len(asyncio.run(session())) == 1
    assert woken == [(private._wake, buffer)]
    private._wake(buffer)
    assert buffer.flush_event.is_set()


def test_what_an_earlier_turn_left_is_sent_with_the_next(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a browser's sender found held back by the next turn is sent behind it, though that one sent nothing."""
    buffer, woken = server._websock_server._broadcast_buffer, []
    server.scene.add_frame("/node")
    monkeypatch.setattr(buffer.event_loop, "call_soon_threadsafe", lambda *args: woken.append(args))
    monkeypatch.setattr(buffer, "generator_cursors", {99: buffer.message_counter - 2})
    with private.one_message(server):
        pass
    assert woken == [(private._wake, buffer)]
    buffer.generator_cursors[99] = buffer.message_counter - 1
    with private.one_message(server):
        pass
    assert len(woken) == 1


def test_icons_come_from_one_opened_archive(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same drawings, for one look into the archive; viser's own way is back afterwards."""
    names = ["sun", "moon", "camera"]
    plain = [_icons.svg_from_icon.__wrapped__(name) for name in names]
    opened: list[object] = []
    real = zipfile.ZipFile
    monkeypatch.setattr(zipfile, "ZipFile", lambda *args: opened.append(args) or real(*args))
    with private.icons_at_hand():
        assert [_icons.svg_from_icon.__wrapped__(name) for name in names] == plain
    assert len(opened) == 1
    assert _icons.zipfile is zipfile


def test_the_page_of_viser_is_found() -> None:
    """The single file of the client is there and has the places where ours goes in."""
    index = private.INDEX.read_bytes()
    assert b"<title>Viser</title>" in index
    assert b"</head>" in index

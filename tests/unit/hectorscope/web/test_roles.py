"""Roles, tested from outside: what a viewer's messages change (nothing), and which operator acts."""

import asyncio
import urllib.error
import urllib.request
from collections.abc import Iterator

import msgspec.msgpack
import pytest
import viser
from websockets.asyncio.client import ClientConnection, connect

from hectorscope.page.viser_private import uuid_of
from hectorscope.session.commands import Inspect
from hectorscope.session.station_commands import HandOver
from hectorscope.web.access_control import AccessControl
from hectorscope.web.address import ServerError
from hectorscope.web.server import PageServer
from tests.page import StillEngine, room_snapshot
from tests.unit.hectorscope.web.test_guarded_server import CAMERA

OPERATOR, VIEWER = "operator-1234", "viewer-5678"


class Station:
    """A page with roles, and a button and a slider of its own that a test watches."""

    def __init__(self) -> None:
        self.engine = StillEngine(room_snapshot())
        self.page = PageServer(self.engine, port=0, token=OPERATOR, viewer_token=VIEWER)
        self.page.start()
        gui = self.page.scene.server.gui
        self.clicks = 0
        self.button = gui.add_button("A button")
        self.slider = gui.add_slider("A slider", 0.0, 10.0, 1.0, 5.0)
        self.triggered = 0
        self.command = gui.add_command("A command", hotkey="x")

        @self.button.on_click
        def _(_: object) -> None:
            self.clicks += 1

    @property
    def port(self) -> int:
        """Where it is served."""
        return self.page.scene.server.get_port()

    def socket(self, token: str) -> connect:
        """A connection as a page makes it, or any program that has the token."""
        return connect(
            f"ws://127.0.0.1:{self.port}/",
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            additional_headers={"Cookie": f"hectorscope_{self.port}={token}"},
            max_size=None,
        )

    async def click(self, socket: ClientConnection) -> None:
        """Press the button, as a page does that has said where its camera is."""
        await say(socket, CAMERA)
        await say(socket, {"type": "GuiUpdateMessage", "uuid": uuid_of(self.button), "updates": {"value": True}})


async def say(socket: ClientConnection, message: object) -> None:
    """Send it."""
    await socket.send(msgspec.msgpack.encode(message))


async def wait_for(holds: object) -> None:
    """Until it does."""
    for _ in range(500):
        if holds():  # type: ignore[operator]
            return
        await asyncio.sleep(0.01)
    raise AssertionError("waited in vain")


@pytest.fixture
def station() -> Iterator[Station]:
    made = Station()
    yield made
    made.page.stop()


def fetched(port: int, path: str, **headers: str) -> tuple[int, str, str]:
    """Status, type and text of an answer."""
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers=headers)
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, answer.headers["Content-Type"], answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, "", ""


def test_a_viewers_messages_change_nothing(station: Station) -> None:
    """Every kind of message that a page can send, and some that none sends; then an operator's click acts."""
    uuids = list(station.page.scene.server.gui._gui_input_handle_from_uuid)

    async def attack() -> None:
        async with station.socket(VIEWER) as viewer:
            for uuid in uuids:
                for value in (True, False, 9.0, 3, "text", '{"count": 1, "on": true}', [1.0, 2.0]):
                    await viewer.send(
                        msgspec.msgpack.encode(
                            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}
                        )
                    )
            await viewer.send(
                msgspec.msgpack.encode({"type": "CommandTriggerMessage", "uuid": uuid_of(station.button)})
            )
            for kind in ("HectorscopeTakeControl", "ShareUrlRequest", "GuiModalMessage", "RunJavascriptMessage"):
                await viewer.send(msgspec.msgpack.encode({"type": kind}))
            await say(viewer, {"type": "HectorscopePage", "page": 0.5})
            await station.click(viewer)
            await wait_for(station.page.scene.server.get_clients)  # by its camera: what came before was read
            async with station.socket(OPERATOR) as operator:
                await station.click(operator)
                await wait_for(lambda: station.clicks)

    asyncio.run(attack())
    assert station.clicks == 1
    assert station.slider.value == 5.0
    acted = [command for command in station.engine.sent if not isinstance(command, Inspect)]
    assert [type(command) for command in acted] == [HandOver]  # a closer look is the viewer's own


def test_what_a_page_asks_for_is_told_to_no_other(station: Station) -> None:
    """Nor to one that comes later: a request may hold the key of the teacher's link, or a person's notes."""
    secret = "the-key-of-the-teacher"
    field = next(
        uuid
        for uuid, control in station.page.scene.server.gui._gui_input_handle_from_uuid.items()
        if control.label == "export"
    )
    request = {"type": "GuiUpdateMessage", "uuid": field, "updates": {"value": f'{{"notes": "{secret}"}}'}}

    outgoing = station.page.scene.server.gui._websock_interface
    told, queue = [], outgoing.queue_message

    def noted(message: object) -> None:
        told.append(str(vars(message)))
        queue(message)

    async def ask() -> None:
        async with station.socket(OPERATOR) as page:
            await say(page, CAMERA)
            await say(page, request)
            await say(
                page,
                {"type": "GuiUpdateMessage", "uuid": uuid_of(station.slider), "updates": {"value": 7.5}},
            )
            await wait_for(lambda: station.slider.value == 7.5)

    outgoing.queue_message = noted
    asyncio.run(ask())
    assert any("7.5" in message for message in told)
    assert not any(secret in message for message in told)


def test_one_operator_acts_at_a_time(station: Station) -> None:
    """The first one that acts is in control; another one acts only once it has taken that, and then alone."""

    async def two() -> None:
        async with station.socket(OPERATOR) as first, station.socket(OPERATOR) as second:
            await station.click(first)
            await wait_for(lambda: station.clicks == 1)
            await station.click(second)
            await say(second, {"type": "HectorscopePage", "page": 0.25})
            await say(second, {"type": "HectorscopeTakeControl"})
            await say(second, {"type": "HectorscopePage", "page": float("nan")})
            await station.click(second)
            await wait_for(lambda: station.clicks == 2)
            assert station.page.roles.script() == "window.hectorscope?.inControl?.(0.25)"
            await station.click(first)
            await station.click(second)
            await wait_for(lambda: station.clicks == 3)

    asyncio.run(two())
    assert station.clicks == 3
    assert station.engine.sent == [HandOver("127.0.0.1"), HandOver("127.0.0.1")]


def test_control_is_free_once_its_browser_has_gone(station: Station) -> None:
    """The next operator that acts gets it."""

    async def leave() -> None:
        async with station.socket(OPERATOR) as first:
            await station.click(first)
        await wait_for(lambda: station.page.roles.in_control is None)
        async with station.socket(OPERATOR) as second:
            await station.click(second)
            await wait_for(lambda: station.clicks == 2)

    asyncio.run(leave())


def test_the_page_learns_its_role_by_the_cookie(station: Station) -> None:
    """Each token is exchanged for a cookie with that token; nobody without one hears anything."""
    for token, role in ((OPERATOR, "operator"), (VIEWER, "viewer")):
        cookie = f"hectorscope_{station.port}={token}"
        assert fetched(station.port, "/role", Cookie=cookie)[2] == role
    assert fetched(station.port, "/role")[0] == 401
    assert fetched(station.port, f"/?token={VIEWER}x")[0] == 401


def test_metrics_are_behind_the_token(station: Station) -> None:
    """A monitor brings it as a bearer token; the figures are those of the run, in Prometheus' text format."""
    status, kind, text = fetched(station.port, "/metrics", Authorization=f"Bearer {VIEWER}")
    assert (status, kind) == (200, "text/plain; version=0.0.4; charset=utf-8")
    lines = text.splitlines()
    assert "# TYPE hectorscope_scans_total counter" in lines
    assert "hectorscope_scans_total 40.0" in lines
    assert 'hectorscope_tracking{state="tracking"} 1.0' in lines
    assert all(line.startswith(("# HELP hectorscope_", "# TYPE hectorscope_", "hectorscope_")) for line in lines)
    assert fetched(station.port, "/metrics")[0] == 401
    assert fetched(station.port, "/metrics", Authorization="Bearer nothing")[0] == 401


def test_a_viewer_sends_no_recordings() -> None:
    """The path of the uploads is the operator's."""
    access = AccessControl({}, OPERATOR, any_host=True, uploads=True, viewer_token=VIEWER)
    asked = {"host": "a", "upgrade": "websocket"}
    opens = [
        (path, access.admits_socket(path, {**asked, "cookie": f"hectorscope={token}"}))
        for path in ("/", "/upload")
        for token in (OPERATOR, VIEWER, "another-one")
    ]
    assert [open_ for _, open_ in opens] == [True, True, False, True, False, False]


@pytest.mark.parametrize(
    ("token", "viewer"),
    [(None, VIEWER), (OPERATOR, OPERATOR), (OPERATOR, "short")],
    ids=["alone", "same", "short"],
)
def test_a_viewers_token_of_no_use_is_refused(token: str | None, viewer: str) -> None:
    """Before anything is served, with the remedy."""
    with pytest.raises(ServerError, match="give"):
        PageServer(StillEngine(), port=0, token=token, viewer_token=viewer)

"""The server of a sweep's page: who gets what, and what it opens."""

import http.client
import json
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from hectorscope.exporters import OutputError
from hectorscope.run.settings_file import read_toml, to_toml
from hectorscope.sweep.spec import RunSpec, RunSummary
from hectorscope.sweep.table import Table, write_details
from hectorscope.web.address import ServerError
from hectorscope.web.sweep_files import SweepFiles
from hectorscope.web.sweep_server import SweepServer
from hectorscope.web.viewers import ViewerError, spec_of, view_arguments
from slam_core.errors import SlamError

SPEC = RunSpec(
    "<b>.bag",
    "/nowhere/<b>.bag",
    {"matcher.sigma": 0.1},
    options={"scan_delay": 0.1, "scan_topic": "/scan", "laser_pose": (1.0, 0.0, 0.0, 0.0, 0.0, 0.5)},
    repair=True,
)
TOKEN = "secret-of-many-letters"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A sweep of two runs, one of them without figures."""
    table = Table(tmp_path, ["matcher.sigma"])
    table.append(SPEC, RunSummary("ok", figures={"consistency": 0.5}, picture="AAAA"))
    table.append(RunSpec("c.bag", "/nowhere/c.bag"), RunSummary("timeout", "it took long"))
    return tmp_path


@pytest.fixture
def server(folder: Path) -> Iterator[SweepServer]:
    made = SweepServer(folder, port=0)
    made.start()
    yield made
    made.stop()


def asked(
    server: SweepServer, method: str, path: str, headers: dict[str, str] | None = None, body: str = ""
) -> tuple[int, bytes, dict[str, str]]:
    """Status, content and headers of one request, as any program may send it."""
    place = urlsplit(server.url)
    connection = http.client.HTTPConnection(place.hostname or "", place.port, timeout=20)
    connection.request(method, path, body or None, headers or {})
    reply = connection.getresponse()
    found = reply.status, reply.read(), {name.lower(): value for name, value in reply.getheaders()}
    connection.close()
    return found


def own(server: SweepServer) -> dict[str, str]:
    """The header that a browser sends from our page."""
    return {"Origin": server.url.rstrip("/")}


def test_the_page_and_its_data_are_served(server: SweepServer):
    """With numbers as numbers, the policy that keeps scripts to our own, and no version of anything."""
    status, page, headers = asked(server, "GET", "/")
    assert status == 200
    assert b"/static/sweep/sweep.js" in page
    assert "script-src 'self'" in headers["content-security-policy"]
    assert "server" not in headers
    data = json.loads(asked(server, "GET", "/data.json")[1])
    assert data["target"] == "consistency"
    assert [(row["recording"], row["matcher.sigma"], row["consistency"]) for row in data["rows"]] == [
        ("<b>.bag", 0.1, 0.5),
        ("c.bag", 0.2, None),
    ]
    details = json.loads(asked(server, "GET", f"/run/{SPEC.key}.json")[1])
    assert details["picture"] == "AAAA"


@pytest.mark.parametrize(
    "path",
    ["/runs.csv", "/../runs.csv", "/run/..%2f..%2fruns.csv.json", "/run/0123456789abcdef.json", "/details/"],
)
def test_nothing_else_of_the_disk_is_served(server: SweepServer, path: str):
    """Neither the table itself nor anything by a path."""
    assert asked(server, "GET", path)[0] == 404


@pytest.mark.parametrize(
    ("method", "path", "headers", "status"),
    [
        ("GET", "/", {"Host": "evil.example"}, 421),
        ("GET", "/", {"Origin": "http://evil.example"}, 403),
        ("GET", "/", {"Upgrade": "websocket", "Connection": "Upgrade"}, 403),
        ("POST", "/open", {}, 403),
        ("POST", "/open", {"Origin": "http://evil.example"}, 403),
        ("POST", "/open", {"Host": "evil.example", "Origin": "http://evil.example"}, 421),
        ("PUT", "/open", {}, 501),
    ],
)
def test_strangers_are_refused(server: SweepServer, method: str, path: str, headers: dict[str, str], status: int):
    """Other sites by another host or origin, and whoever asks to open a run from elsewhere than the page."""
    assert asked(server, method, path, headers, '{"key": "0"}' if method == "POST" else "")[0] == status


@pytest.mark.parametrize("body", ["", "{", "[]", '{"key": 1}', '{"key": "../../x"}', "[" * 900, "x" * 5000])
def test_what_is_no_run_opens_nothing(server: SweepServer, body: str):
    """Whatever a browser sends."""
    assert asked(server, "POST", "/open", own(server), body)[0] == 400


def test_a_run_that_cannot_be_opened_says_why(server: SweepServer):
    """The reason of the command `view`, for the page."""
    status, content, _ = asked(server, "POST", "/open", own(server), json.dumps({"key": SPEC.key}))
    assert status == 200
    assert "<b>.bag does not exist" in json.loads(content)["error"]


def test_a_token_is_asked_for(folder: Path):
    """By the page, the data and the opening of runs; the address brings it in, a cookie keeps it."""
    server = SweepServer(folder, port=0, token=TOKEN)
    server.start()
    try:
        assert asked(server, "GET", "/data.json")[0] == 401
        assert asked(server, "POST", "/open", {"Origin": "http://127.0.0.1"}, "{}")[0] in {401, 403}
        status, _, headers = asked(server, "GET", f"/?token={TOKEN}")
        assert status == 303
        cookie = headers["set-cookie"].partition(";")[0]
        assert asked(server, "GET", "/data.json", {"Cookie": cookie})[0] == 200
    finally:
        server.stop()


def test_an_open_address_needs_a_token(folder: Path):
    """As that of a run does."""
    with pytest.raises(ServerError, match="give a token too"):
        SweepServer(folder, host="0.0.0.0", port=0)
    with pytest.raises(OutputError, match=r"has no runs.csv"):
        SweepServer(folder / "details", port=0)


def test_a_growing_table_is_read_again(folder: Path):
    """A row that is added while the page is open is in the next answer."""
    files = SweepFiles(folder)
    assert len(json.loads(files["/data.json"].content)["rows"]) == 2
    Table(folder, []).append(RunSpec("d.bag", "/d.bag"), RunSummary("ok"))
    assert len(json.loads(files["/data.json"].content)["rows"]) == 3


def test_the_viewer_gets_the_settings_and_options_of_the_run(folder: Path, tmp_path: Path):
    """The command has what the spec has: settings and sensors in a file, topics and the mount as flags."""
    spec = spec_of(folder, SPEC.key)
    assert spec == SPEC
    config = tmp_path / "config.toml"
    config.write_text(to_toml(spec.run_settings(), {"scan_delay": 0.1}))
    assert read_toml(config).start.matcher.sigma == 0.1
    assert view_arguments(spec, config) == [
        *("view", "/nowhere/<b>.bag", "--config", str(config)),
        *("--laser-pose", "1.0", "0.0", "0.0", "0.0", "0.0", "0.5", "--scan-topic=/scan", "--repair"),
    ]


def test_details_that_somebody_else_wrote_bring_no_flags(tmp_path: Path):
    """A name that is no option, a value that looks like a flag, and a path that does."""
    config = tmp_path / "config.toml"
    shifty = RunSpec("a", "/a.bag", options={"scan_topic": "--out=/elsewhere"})
    assert "--scan-topic=--out=/elsewhere" in view_arguments(shifty, config)
    with pytest.raises(ViewerError, match="is no absolute path"):
        view_arguments(RunSpec("a", "--out=x"), config)
    write_details(tmp_path, RunSpec("a", "/a.bag", options={"out": "/elsewhere"}), RunSummary("ok"))
    with pytest.raises(SlamError, match="of another version"):
        spec_of(tmp_path, RunSpec("a", "/a.bag", options={"out": "/elsewhere"}).key)


def test_a_table_that_cannot_be_read_is_told(server: SweepServer, folder: Path) -> None:
    """With the reason as the answer, and the server goes on."""
    (folder / "runs.csv").write_text("no,table\n", encoding="utf-8")
    status, content, _ = asked(server, "GET", "/data.json")
    assert (status, b"is no table of a sweep" in content) == (500, True)
    assert asked(server, "GET", "/")[0] == 200

"""A recording that a browser sends: taken piece by piece, within the limit, and never under a path of its own."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest

from hectorscope.web import uploads as module
from hectorscope.web.uploads import Uploads

LIMIT = 1000


class Browser:
    """Sends what the test says and keeps the answers; gone when it has nothing more."""

    def __init__(self, *messages: str | bytes) -> None:
        self._messages = list(messages)
        self.answers: list[dict[str, Any]] = []

    async def piece(self) -> str | bytes:
        """The next."""
        if not self._messages:
            raise ConnectionError("gone")
        return self._messages.pop(0)

    async def send(self, message: str) -> None:
        """Keep it."""
        self.answers.append(json.loads(message))


def content(path: Path) -> bytes:
    """Of a file, or of all of a folder."""
    return path.read_bytes() if path.is_file() else b"".join(each.read_bytes() for each in sorted(path.iterdir()))


class Shelf:
    """What arrived."""

    def __init__(self, limit: int = LIMIT) -> None:
        self.arrived: list[tuple[Path, str, bytes]] = []
        self.uploads = Uploads(limit, lambda path, name: self.arrived.append((path, name, content(path))))

    def receive(self, *messages: str | bytes) -> list[dict[str, Any]]:
        """The answers to a browser that sends these."""
        browser = Browser(*messages)
        try:
            asyncio.run(self.uploads.receive(browser))
        except ConnectionError:
            browser.answers.append({"gone": True})
        return browser.answers

    def files(self) -> list[Path]:
        """What lies in the folder."""
        assert self.uploads._folder is not None
        return list(Path(self.uploads._folder.name).iterdir())


def head(name: str, size: object) -> str:
    return json.dumps({"name": name, "size": size})


def folder(name: str, *files: object) -> str:
    return json.dumps({"name": name, "files": files})


def test_a_recording_arrives_whole() -> None:
    """The server says go, takes the pieces in order, and tells when it has all; the end removes it."""
    shelf = Shelf()
    answers = shelf.receive(head("run.bag", 6), b"abc", b"def")
    assert answers == [{"send": 6}, {"arrived": "run.bag"}]
    ((path, name, content),) = shelf.arrived
    assert (name, content, path.suffix) == ("run.bag", b"abcdef", ".bag")
    shelf.uploads.close()
    assert not path.parent.exists()


def test_a_folder_arrives_whole() -> None:
    """Its files keep their order, and nothing of their names but the suffix."""
    shelf = Shelf()
    said = folder("../run", ["../../run_0.db3", 2], ["run_1.db3", 3], ["/etc/run_2.mcap", 1])
    answers = shelf.receive(said, b"ab", b"c", b"de", b"f")
    assert answers == [{"send": 6}, {"arrived": "run"}]
    ((path, name, content),) = shelf.arrived
    assert (name, content) == ("run", b"abcdef")
    assert [each.name for each in sorted(path.iterdir())] == [
        "sent_0000.db3", "sent_0001.db3", "sent_0002.mcap",
    ]  # fmt: skip
    assert [each.name for each in shelf.files()] == ["0"]
    shelf.uploads.close()
    assert not path.exists()


def test_a_folder_that_does_not_come_whole_leaves_nothing() -> None:
    """Its room is free again; beyond the limit it is not begun."""
    shelf = Shelf()
    said = folder("run", ["a.db3", 2], ["b.db3", 3])
    assert shelf.receive(said, b"ab", b"c")[-1] != {"arrived": "run"}
    assert "refused" in shelf.receive(said, b"abc")[-1]
    assert shelf.arrived == shelf.files() == []
    assert "--upload-limit" in shelf.receive(folder("run", ["a.db3", 600], ["b.db3", 401]))[0]["refused"]
    assert shelf.receive(folder("run", ["a.db3", LIMIT]), b"x" * LIMIT)[-1] == {"arrived": "run"}
    shelf.uploads.close()


def test_a_folder_that_cannot_be_made_is_refused_with_the_reason() -> None:
    """The browser hears the reason and the remedy, and the next one may send."""
    shelf = Shelf()
    shelf.receive(head("run.bag", 1), b"x")
    (shelf.arrived[0][0].parent / "1").touch()
    refused = shelf.receive(folder("run", ["a.db3", 2]), b"ab")[-1]["refused"]
    assert refused == "the recording cannot be kept (File exists): set TMPDIR to another disk"
    assert shelf.receive(folder("run", ["a.db3", 2]), b"ab")[-1] == {"arrived": "run"}
    shelf.uploads.close()


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("../../etc/run.bag", "run.bag"),
        ("C:\\bags\\run.bag", "run.bag"),
        ("a\x1b[31m\n.bag", "a\N{REPLACEMENT CHARACTER}[31m\N{REPLACEMENT CHARACTER}.bag"),
        ("x" * 500 + ".mcap", "x" * 115 + ".mcap"),
        ("..bag", "..bag"),
    ],
)
def test_the_name_is_only_a_label(name: str, label: str) -> None:
    """No part of it but a known suffix is in the path; the label is short and can be printed."""
    shelf = Shelf()
    shelf.receive(head(name, 1), b"x")
    ((path, shown, _),) = shelf.arrived
    assert shown == label
    assert path.name in ("0.bag", "0.mcap")
    shelf.uploads.close()


def test_beyond_the_limit_a_recording_is_refused() -> None:
    """Together with those that came before; the remedy is named, and nothing of it is kept."""
    shelf = Shelf()
    shelf.receive(head("first.bag", 600), b"x" * 600)
    (refused,) = shelf.receive(head("second.bag", 401))
    assert "second.bag has" in refused["refused"] and "--upload-limit" in refused["refused"]
    assert [path.name for path in shelf.files()] == ["0.bag"]
    assert shelf.receive(head("third.bag", 400), b"x" * 400)[-1] == {"arrived": "third.bag"}
    shelf.uploads.close()


@pytest.mark.parametrize("pieces", [(b"x" * 11,), (b"x" * 6, b"x" * 5), ("text",), (b"",), (b"x" * 4,)], ids=len)
def test_what_is_not_as_announced_leaves_nothing(pieces: tuple[str | bytes, ...]) -> None:
    """More than was said, another kind of message, a browser that goes: the file is removed, the room is free."""
    shelf = Shelf()
    answers = shelf.receive(head("run.bag", 10), *pieces)
    assert "refused" in answers[-1] or answers[-1] == {"gone": True}
    assert shelf.arrived == shelf.files() == []
    assert shelf.receive(head("next.bag", LIMIT), b"x" * LIMIT)[-1] == {"arrived": "next.bag"}
    shelf.uploads.close()


@pytest.mark.parametrize(
    "first",
    [
        b"bytes", "{", "[]", "null", "[" * 1500, "x" * 50_000, head("run.bag", -1), head("run.bag", True), "{}",
        head("run.bag", 1.5), head("run.bag", "9"), '{"name": 3, "size": 9}', head("run.exe", 9), head("run", 9),
        head(".", 9), head("", 9), head("run.bag", 0),
        folder("run"), folder("run", 3), folder("run", ["a.db3"]), folder("run", ["a.db3", -1]),
        folder("run", ["metadata.yaml", 9]), folder("run", ["a.bag", 9]), folder("run", ["a.db3", 0]),
        folder("run", ["a.db3", 9], "b.db3"), folder("run", *([["a.db3", 1]] * 201)),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_in_a_sentence(first: str | bytes) -> None:
    """And no folder is made for it."""
    shelf = Shelf()
    (answer,) = shelf.receive(first)
    assert answer["refused"]
    assert shelf.uploads._folder is None


def test_a_browser_that_falls_silent_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its room is free again."""
    monkeypatch.setattr(module, "IDLE_S", 0.01)

    class Silent(Browser):
        async def piece(self) -> str | bytes:
            return await super().piece() if self._messages else await asyncio.sleep(60.0, b"")

    shelf, browser = Shelf(), Silent(head("run.bag", 10), b"x")
    asyncio.run(shelf.uploads.receive(browser))
    assert "nothing came" in browser.answers[-1]["refused"]
    assert shelf.files() == []
    shelf.uploads.close()

"""The client of viser as files of its own."""

import logging
import subprocess
import sys

import pytest

from hectorscope.page import viser_client
from hectorscope.page.viser_client import unpacked
from hectorscope.page.viser_private import INDEX


def test_style_script_and_decoder_are_found() -> None:
    """The page names three files by what is in them, and no longer holds them."""
    index = INDEX.read_bytes()
    client = unpacked(index)
    kinds = {file.kind.partition(";")[0]: (path, file) for path, file in client.files.items()}
    assert set(kinds) == {"text/css", "text/javascript", "application/wasm"}
    for path, file in kinds.values():
        assert path.removeprefix("/").encode() in client.page
        assert file.lasting
    assert len(client.page) < 10_000 < len(index)
    assert kinds["application/wasm"][1].content.startswith(b"\0asm")
    assert b"createRoot" in kinds["text/javascript"][1].content
    assert b"<title>Viser</title>" in client.page


def test_the_scene_begins_unlit() -> None:
    """The lights and reflections that viser's client begins with are in its script, and are taken out."""
    script = next(file.content for path, file in unpacked(INDEX.read_bytes()).files.items() if "script" in path)
    for before, after in viser_client.CHANGES:
        assert before not in script
        assert script.count(after) == 1


@pytest.mark.parametrize(
    ("before", "after"),
    [(b'data-cs="', b'data-cs="1'), (b"data-p=", b"data-q="), (b'data-p="', b'data-p="!!!!!')],
    ids=["other sizes", "other names", "other bytes"],
)
def test_another_way_of_packing_is_served_as_it_is(
    before: bytes, after: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    """The page then works as viser made it, with a warning."""
    index = INDEX.read_bytes().replace(before, after, 1)
    with caplog.at_level(logging.WARNING):
        client = unpacked(index)
    assert client.page == index
    assert not client.files
    assert "is served as it is" in caplog.text


def test_the_page_needs_no_compiler() -> None:
    """What is served comes without numba, whose import would keep a browser waiting."""
    code = "import sys, hectorscope.cli.main, hectorscope.cli.page; sys.exit('numba' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)

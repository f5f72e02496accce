"""The client of viser, taken out of its single file, so that a browser begins sooner and keeps it.

viser serves one HTML file, in which its style sheet and script are packed as text that a script unpacks. As files
of their own, browsers unpack them faster, compile them while they arrive, and do not ask again. The script is
changed in two places: it begins without lights, shadows and reflections, which the scene replaces at once, and it
does not write the address of its server into that of the page, as it does below a path.
"""

import gzip
import json
import logging
import re
import zlib
from typing import NamedTuple

import numpy as np
import zstandard

from hectorscope.page.static_files import File

log = logging.getLogger(__name__)

# Every printable character that needs no escape in HTML; five of them are four bytes.
ALPHABET = bytes(sorted(set(range(0x21, 0x7F)) - set(b"\"&<>'`")))
BASE = len(ALPHABET)
LOADER = re.compile(
    rb'<script data-p="(?P<packed>[^"]+)" data-ss="(?P<style>\d+)" data-cs="(?P<script>\d+)">'
    rb"(?P<code>.*?)</script>",
    re.DOTALL,
)
DECODER = re.compile(rb'=\s*("[^"]{10000,}")')
LIT = b"enableDefaultLights:!0,enableDefaultLightsShadows:!0,environmentMap:null"
UNLIT = (
    b"enableDefaultLights:!1,enableDefaultLightsShadows:!1,environmentMap:{type:`EnvironmentMapMessage`,hdri_data:null,"
    b"background:!1,background_blurriness:0,background_intensity:1,background_wxyz:[1,0,0,0],environment_intensity:1,"
    b"environment_wxyz:[1,0,0,0]}"
)
NAMING = b"n&&t.has(`websocket`)?t.delete(d7):n||t.set(d7,e)"
CHANGES = ((LIT, UNLIT), (NAMING, b"t.delete(d7)"))
# viser takes the part behind "#" from the address, and may come before the scripts that look for it. A proxy may
# offer the page at an address without its last slash, from which no file of it is found.
START = (
    '<link rel="stylesheet" href="{style}"><link rel="modulepreload" href="{script}"><script>'
    "if(!/\\/(index\\.html)?$/.test(location.pathname))"
    'location.replace(location.pathname+"/"+location.search+location.hash);'
    "window.hectorscope={{asked:location.hash}};"
    'WebAssembly.compileStreaming(fetch("{decoder}")).then((made)=>{{'
    'globalThis.__viserZstdWasm=made;return import("./{script}")}})</script>'
)


class Client(NamedTuple):
    """page: the HTML, which names the files. files: by path; none where viser packs in another way."""

    page: bytes
    files: dict[str, File]


def unpacked(index: bytes) -> Client:
    """The client of viser's `index.html`; the page as it is if its style sheet and script are not found in it."""
    try:
        loader = _found(LOADER.search(index))
        decoder = gzip.decompress(_decoded(json.loads(_found(DECODER.search(loader["code"]))[1]).encode()))
        style, script = _parts(loader)
    except (ValueError, OSError, zstandard.ZstdError) as error:
        log.warning("the client of this viser is served as it is: %s", error)
        return Client(index, {})
    for before, after in CHANGES:
        script = script.replace(before, after, 1)
    named = {
        "style": File("text/css; charset=utf-8", style, lasting=True),
        "script": File("text/javascript; charset=utf-8", script, lasting=True),
        "decoder": File("application/wasm", decoder, lasting=True),
    }
    paths = {name: f"client/{name}-{zlib.crc32(file.content):08x}" for name, file in named.items()}
    start = START.format(**paths).encode()
    page = index[: loader.start()] + start + index[loader.end() :]
    return Client(page, {f"/{paths[name]}": file for name, file in named.items()})


def _found(match: re.Match[bytes] | None) -> re.Match[bytes]:
    if match is None:
        raise ValueError("it is packed in another way")
    return match


def _parts(loader: re.Match[bytes]) -> tuple[bytes, bytes]:
    """Style sheet and script: one frame holds both."""
    style, script = int(loader["style"]), int(loader["script"])
    unpacker = zstandard.ZstdDecompressor()
    both = unpacker.decompress(_decoded(loader["packed"]), max_output_size=style + script)
    if len(both) != style + script:
        raise ValueError(f"it has {len(both)} bytes instead of {style + script}")
    return both[:style], both[style:]


def _decoded(text: bytes) -> bytes:
    """The bytes of a text in base 88: four from five characters, and k - 1 from the last k."""
    values = np.zeros(256, np.uint64)
    values[list(ALPHABET)] = np.arange(BASE, dtype=np.uint64)
    whole = len(text) - len(text) % 5
    digits = values[np.frombuffer(text[:whole], np.uint8)].reshape(-1, 5)
    words = digits @ np.array([BASE**k for k in (4, 3, 2, 1, 0)], np.uint64)
    rest = 0
    for character in text[whole:]:
        rest = rest * BASE + int(values[character])
    return words.astype(">u4").tobytes() + rest.to_bytes(max(0, len(text) - whole - 1), "big")

"""What the server hands out by HTTP: the page with our style and scripts in it, and the files of static/."""

import gzip
import mimetypes
import zlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

LEVEL = 6  # of compression: 9 takes half as long again for two thousandths less
TEXT = {".css": "text/css", ".js": "text/javascript", ".html": "text/html", ".svg": "image/svg+xml"}


@dataclass(frozen=True)
class File:
    """Bytes with their media type. lasting: what is at its path never changes."""

    kind: str
    content: bytes
    lasting: bool = False

    @cached_property
    def zipped(self) -> bytes:
        """The same, compressed once."""
        return gzip.compress(self.content, LEVEL, mtime=0)


def static_files(folder: Path) -> dict[str, File]:
    """Every file below `folder` as "/static/...", read now: nothing else on the disk can ever be asked for."""
    found = sorted(path for path in folder.rglob("*") if path.is_file())
    return {
        f"/static/{path.relative_to(folder).as_posix()}": File(media_type(path), path.read_bytes())
        for path in found
    }


def media_type(path: Path) -> str:
    """By the ending; text is UTF-8."""
    if kind := TEXT.get(path.suffix):
        return f"{kind}; charset=utf-8"
    return mimetypes.guess_type(path.name)[0] or "application/octet-stream"


def page(index: bytes, static: dict[str, File]) -> dict[str, File]:
    """The page of viser under our title, and the two files that its head names, by path.

    They hold the style sheets and the scripts of static/'s top level, one after the other: forty requests hold
    up a server that is just starting, and browsers keep these two.
    """
    top = {path: file for path, file in static.items() if path.count("/") == 2}
    style, script = _joined(top, ".css"), _joined(top, ".js")
    style_path, script_path = (f"page/{zlib.crc32(file.content):08x}" for file in (style, script))
    head = f'<link rel="stylesheet" href="{style_path}"><script defer src="{script_path}"></script>'
    html = index.replace(b"<title>Viser</title>", b"<title>Hectorscope</title>", 1)
    html = html.replace(b"</head>", head.encode() + b"</head>", 1)
    return {"/": File(f"{TEXT['.html']}; charset=utf-8", html), f"/{style_path}": style, f"/{script_path}": script}


def _joined(files: dict[str, File], ending: str) -> File:
    content = b"\n".join(file.content for path, file in files.items() if path.endswith(ending))
    return File(media_type(Path(f"page{ending}")), content, lasting=True)

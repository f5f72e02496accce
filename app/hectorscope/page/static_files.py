"""What the server hands out by HTTP: the page with our style and scripts in it, and the files of static/."""

import gzip
import mimetypes
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


def page(index: bytes, static: dict[str, File]) -> File:
    """The page of viser under our title, with the style sheets and scripts of static/'s top level in its head."""
    names = [name.removeprefix("/") for name in static if name.count("/") == 2]
    styles = [f'<link rel="stylesheet" href="{name}">' for name in names if name.endswith(".css")]
    scripts = [f'<script defer src="{name}"></script>' for name in names if name.endswith(".js")]
    head = "".join((*styles, *scripts)).encode()
    return File(
        "text/html; charset=utf-8",
        index.replace(b"<title>Viser</title>", b"<title>Hectorscope</title>", 1).replace(
            b"</head>", head + b"</head>", 1
        ),
    )

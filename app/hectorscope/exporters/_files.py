"""Files that are whole or not there at all, and the times in them."""

import os
from pathlib import Path


def exact_seconds(start_ns: int, seconds: float) -> str:
    """A time in seconds with all its nanoseconds, which the float of a date could not hold."""
    stamp_ns = start_ns + round(seconds * 1e9)
    return f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d}"


def write_whole(path: Path, content: bytes) -> None:
    """Write under a temporary name beside `path`, then rename; an older file stays until then."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)

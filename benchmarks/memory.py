"""Memory of a process of Linux, in MiB."""

from pathlib import Path

HELD = "RssAnon", "RssShmem"  # what a process has to hold
FILES = ("RssFile",)  # pages of files, which the system takes back when it needs room


def resident(kinds: tuple[str, ...], process: int | str = "self") -> float:
    """What of a process is in memory, of these kinds."""
    lines = Path(f"/proc/{process}/status").read_text("utf-8").splitlines()
    status = dict(line.split(":", 1) for line in lines)
    return sum(int(status[kind].split()[0]) for kind in kinds) / 1024

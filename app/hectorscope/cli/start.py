"""The beginning of the command: an interruption is one while the program is still loaded, too."""

import sys

from hectorscope.cli.interruption import INTERRUPTED


def main() -> int:
    """Load the command line and run a command; its exit code."""
    try:
        from hectorscope.cli.main import main as command  # noqa: PLC0415 - takes a moment, in which one may interrupt

        return command()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED

"""What stands in the way to a file that a person named."""

from pathlib import Path


def absence(path: Path) -> str:
    """Why nothing is found at a path, as a message says it; empty if there is something."""
    try:
        path.stat()
    except FileNotFoundError:
        return "does not exist"
    except OSError as error:  # a name that is too long, a folder that is locked
        return f"cannot be reached ({error.strerror})"
    return ""

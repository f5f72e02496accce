"""Why a file that a person named cannot be used."""

from pathlib import Path


def absence(path: Path) -> str:
    """Why nothing is found at a path, as part of a message; empty if there is something."""
    try:
        path.stat()
    except FileNotFoundError:
        return "does not exist"
    except OSError as error:  # a name that is too long, a folder that is locked
        return f"cannot be reached ({error.strerror})"
    return ""

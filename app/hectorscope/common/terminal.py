"""What gets to a terminal: text without the characters that it obeys, and no log of a library."""

import logging


def printable(line: str) -> str:
    """The line with a mark in the place of everything that is not to be seen: escapes, and newlines too."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line)


def silent_logger(name: str) -> logging.Logger:
    """For a library that logs a traceback whenever its peer does something wrong."""
    logger = logging.getLogger(name)
    logger.setLevel(logging.CRITICAL + 1)
    return logger

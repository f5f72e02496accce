"""Text for a terminal, which obeys some characters: recordings and files may bring any."""


def printable(line: str) -> str:
    """The line with a mark in the place of everything that is not to be seen: escapes, and newlines too."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line)

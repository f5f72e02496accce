"""How work that somebody waits for says how far it is."""

from typing import Protocol


class Report(Protocol):
    """Takes a sentence, which is empty once the work is done, and which share of it is, if that is known."""

    def __call__(self, text: str, share: float | None = None) -> None:
        """From any thread."""

"""What a page shows of the operator's station."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StationState:
    """records: whether the stream is recorded; None if there is no folder for that. recorded: bytes so far.

    warnings: what cannot be written, with the remedies.
    """

    records: bool | None = None
    recorded: int = 0
    warnings: tuple[str, ...] = ()

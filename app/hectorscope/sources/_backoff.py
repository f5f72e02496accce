"""The pauses between attempts to connect: they grow up to a limit, and the attempts go on for ever."""

FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.25, 5.0


def longer(pause_s: float) -> float:
    """The pause after one more attempt that failed; 0 before the first."""
    return min(max(FIRST_PAUSE_S, 2.0 * pause_s), LONGEST_PAUSE_S)

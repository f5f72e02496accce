"""What the engine does while nothing of what is shown is due: runs ahead of it, or lets a stream's run go on."""

from collections.abc import Callable

from hectorscope.session.session import Session

Guard = Callable[[Callable[[], None]], None]

AHEAD_S = 0.008  # how long a command or a scan may wait while a recording is run ahead
BREAK_S = 0.001  # between two such slices the threads that serve the page have the interpreter
FRONT_S = 0.005  # how often it is looked for scans of a stream of which an earlier time is shown


def use_time(session: Session, patience: float | None, guard: Guard) -> float | None:
    """Use some of the time until something is due (None: for ever); seconds until the next such turn, if any.

    guard: calls what may fail.
    """
    if session.past.front:
        guard(session.past.step_front)
        return FRONT_S
    slice_s = AHEAD_S if patience is None else min(AHEAD_S, patience)
    turn = session.run_ahead(slice_s) if slice_s >= BREAK_S else None
    return None if turn is None else max(turn, BREAK_S)

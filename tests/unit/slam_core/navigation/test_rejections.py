from slam_core.navigation.rejections import Rejections
from slam_core.results import AidingStatus


def test_what_was_dropped_joins_what_the_gates_say() -> None:
    """A heard source keeps its figures, one that never came to a gate is told too, the rest is untouched."""
    ledger, statuses = Rejections(), {"gps": AidingStatus("gps", used=3), "scan": AidingStatus("scan", used=9)}
    for source, reason in (("gps", "late"), ("gps", "late"), ("compass", "disturbed")):
        ledger.drop(source, reason)
    told = {status.source: status for status in ledger.statuses(statuses)}
    assert told["scan"] is statuses["scan"]
    assert (told["gps"].used, dict(told["gps"].dropped)) == (3, {"late": 2})
    assert (told["compass"].used, dict(told["compass"].dropped)) == (0, {"disturbed": 1})
    assert ledger.counts == {"late": 2, "disturbed": 1}


def test_what_is_told_is_never_stale() -> None:
    """Told again it is the same; after another drop, or with another status, it is new."""
    ledger, status = Rejections(), AidingStatus("gps", used=3)
    ledger.drop("gps", "late")
    (first,) = ledger.statuses({"gps": status})
    assert ledger.statuses({"gps": status}) == (first,)
    ledger.drop("gps", "late")
    assert dict(ledger.statuses({"gps": status})[0].dropped) == {"late": 2}
    assert ledger.statuses({"gps": AidingStatus("gps", used=4)})[0].used == 4

from slam_core.navigation.aiding.ledger import Ledger
from slam_core.results import AidingStatus


def test_what_was_dropped_joins_what_the_gates_say() -> None:
    """A heard source keeps its figures, one that never came to a gate is told too, the rest is untouched."""
    ledger, statuses = Ledger(), {"gps": AidingStatus("gps", used=3), "scan": AidingStatus("scan", used=9)}
    for source, reason in (("gps", "late"), ("gps", "late"), ("compass", "disturbed")):
        ledger.drop(source, reason)
    told = {status.source: status for status in ledger.told(statuses)}
    assert told["scan"] is statuses["scan"]
    assert (told["gps"].used, dict(told["gps"].dropped)) == (3, {"late": 2})
    assert (told["compass"].used, dict(told["compass"].dropped)) == (0, {"disturbed": 1})
    assert ledger.counts == {"late": 2, "disturbed": 1}


def test_what_is_told_is_never_stale() -> None:
    """Told again it is the same; after another drop, or with another status, it is new."""
    ledger, status = Ledger(), AidingStatus("gps", used=3)
    ledger.drop("gps", "late")
    (first,) = ledger.told({"gps": status})
    assert ledger.told({"gps": status}) == (first,)
    ledger.drop("gps", "late")
    assert dict(ledger.told({"gps": status})[0].dropped) == {"late": 2}
    assert ledger.told({"gps": AidingStatus("gps", used=4)})[0].used == 4


def test_a_copy_of_the_ledger_counts_alone() -> None:
    """What is dropped later is in one of them only."""
    ledger = Ledger()
    ledger.drop("gps", "late")
    other = ledger.copy()
    ledger.drop("gps", "late")
    assert (other.counts["late"], other.told({})[0].dropped["late"]) == (1, 1)

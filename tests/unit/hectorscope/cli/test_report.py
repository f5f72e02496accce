"""What a person at a terminal sees of long work."""

from pathlib import Path

import pytest

from hectorscope.cli.report import summary


def test_names_are_shown_as_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    """Brackets are no markup, and what a terminal would obey is replaced."""
    figures = {
        "tracking": {"tracking": 1},
        "scans": {"used": 1, "read": 2, "skipped": {"/\x1b[31mscan: [/bold] empty": 1}},
        "messages": {"skipped": {}},
        "notes": ["[red]tf"],
        "realtime_factor": 1.0,
        "recording_s": 1.0,
        "wall_s": 1.0,
        "median_us": {"match": 1.0},
        "map_updates": 1,
        "occupied_cells": 1,
        "truth": None,
    }
    summary("[/x].bag", figures, Path("out"))
    shown = capsys.readouterr().out
    assert all(
        words in shown for words in ("[/x].bag", "/\N{REPLACEMENT CHARACTER}[31mscan: [/bold] empty", "[red]tf")
    )

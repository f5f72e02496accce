"""The palette keeps what it promises, and the script that checks it finds a palette that does not."""

from dataclasses import replace

import pytest

from benchmarks.contrast import contrast, findings, main
from hectorscope.page.theme import DARK, LIGHT, Theme


def test_the_palette_is_told_apart_by_every_reader(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Areas, lines, texts and curves of both themes, with and without a colour blindness."""
    monkeypatch.setattr("sys.argv", ["contrast"])
    assert main() == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines and all(line.startswith("ok") for line in lines)
    for word in ("free on unknown", "wall of an upper level", "warning on its chip", "protanopia", "deuteranopia"):
        assert any(word in line for line in lines)
    assert any("tritanopia" in line for line in lines)


@pytest.mark.parametrize(
    "theme, what",
    [
        (replace(LIGHT, background=(232, 235, 240)), "free on unknown"),
        (replace(LIGHT, warning=(186, 104, 0)), "warning"),
        (replace(LIGHT, veil=(0.3, 0.2)), "wall of an upper level on unknown"),
        (replace(DARK, unexpected=(180, 92, 255)), "unexpected"),
        (replace(DARK, unexpected=(220, 154, 255)), "residual 0 / unexpected"),
    ],
)
def test_a_bad_colour_is_found(theme: Theme, what: str) -> None:
    """The colours of before, and a pair that only some readers mix up."""
    assert what in {finding.what for finding in findings(theme) if not finding.good}


def test_contrast_is_that_of_the_standard() -> None:
    """Black on white has 21, a colour on itself 1, and the order does not matter."""
    assert contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21.0)
    assert contrast((9, 99, 199), (9, 99, 199)) == 1.0
    assert contrast((255, 255, 255), (119, 119, 119)) == pytest.approx(4.48, abs=0.01)

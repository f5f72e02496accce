"""What a browser may ask for as an archive."""

from typing import Any

import pytest

from hectorscope.exporters import exporters
from hectorscope.page.scene import Scene
from hectorscope.panels._request import BadRequest
from hectorscope.panels.export import TITLES, ExportPanel, form_html
from hectorscope.run.notes import LONGEST
from hectorscope.web.shared_replay import exporter


def test_every_format_has_its_box_and_words() -> None:
    """Those of the folder and the replay; without one it is not offered."""
    names = [each.name for each in exporters()] + ["html"]
    assert sorted(names) == sorted(TITLES)
    html = form_html(replay=True)
    assert all(f'data-hs-format="{name}"' in html for name in names)
    assert 'data-hs-format="html"' not in form_html(replay=False)


def test_names_and_notes_become_a_command(scene: Scene) -> None:
    """Each format once, notes shortened and in their range."""
    scene.replay = exporter
    asked = {"formats": ["tum", "tum", "html"], "notes": [[-3.0, " turn "], [2, "x" * 900]]}
    command = ExportPanel(scene)._command(4, asked)
    assert command.client == 4
    assert [each.name for each in command.formats] == ["tum", "html"]
    notes = command.formats[1].stream.args[0]  # type: ignore[union-attr]
    assert [(note.seconds, len(note.text)) for note in notes] == [(0.0, 4), (2.0, LONGEST)]


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"formats": [], "notes": []},
        {"formats": ["../etc"], "notes": []},
        {"formats": [["tum"]], "notes": []},
        {"formats": ["tum"], "notes": [["1", "text"]]},
        {"formats": ["tum"], "notes": [[1.0, 5]]},
        {"formats": ["tum"], "notes": [[1.0, " "]]},
        {"formats": ["tum"] * 101, "notes": []},
    ],
)
def test_what_no_script_of_ours_sends_is_refused(scene: Scene, asked: dict[str, Any]) -> None:
    """Unknown formats, wrong types, too many."""
    with pytest.raises(BadRequest):
        ExportPanel(scene)._command(1, asked)

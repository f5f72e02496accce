"""Notes of a shared replay, and what is put around the recorded scene."""

import pytest

from hectorscope.run.notes import LONGEST, Note, NoteError, note
from hectorscope.web.replay import around
from hectorscope.web.shared_replay import exporter


def test_a_note_is_a_time_and_a_text():
    """Seconds since the start; the text may hold what parts them."""
    assert note("12.5=a = b ") == Note(12.5, "a = b")


@pytest.mark.parametrize("wrong", ["", "12", "12=", "=text", "soon=text", "-1=text", "nan=text", f"1={'x' * 501}"])
def test_what_is_no_note_is_refused_with_the_remedy(wrong: str):
    """One message with the words and the form."""
    assert LONGEST == 500
    with pytest.raises(NoteError, match="give "):
        note(wrong)


def test_texts_of_others_end_no_script():
    """Names of recordings and notes may hold anything."""
    page = around("<head></head><body></body>", "", {"notes": [[1.0, "</script><script>alert(1)</script>"]]})
    assert "alert(1)</script>" not in page
    assert "\\u003c/script>" in page


def test_the_format_has_a_name_and_a_file():
    """It is asked for like the others."""
    made = exporter()
    assert (made.name, made.files, made.default) == ("html", ("replay.html",), False)

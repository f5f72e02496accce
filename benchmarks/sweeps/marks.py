"""Figures in a document that a script keeps up to date: each part stands between two marks."""

from pathlib import Path


def fill(path: Path, name: str, text: str) -> None:
    """Put a text between the lines `<!-- NAME -->` and `<!-- /NAME -->`; ValueError where they are missing."""
    head, begin, rest = path.read_text(encoding="utf-8").partition(f"<!-- {name} -->\n")
    _, end, tail = rest.partition(f"<!-- /{name} -->\n")
    if not (begin and end):
        raise ValueError(f"{path.name} has no place for {name}: write the two marks there")
    path.write_text(f"{head}{begin}{text.rstrip()}\n{end}{tail}", encoding="utf-8")

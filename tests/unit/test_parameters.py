"""No function takes more than ten parameters: what belongs together is grouped."""

import ast
from pathlib import Path

import pytest

from tests.conftest import ROOT

MOST = 10
FILES = sorted(path for folder in ("slam_core", "app") for path in (ROOT / folder).rglob("*.py"))


def parameters(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """How many a caller may give; self and cls do not count."""
    given = function.args
    names = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len([name for name in names if name not in {"self", "cls"}])


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_function_has_too_many_parameters(path: Path):
    """Kernels included."""
    functions = (
        node
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    )
    assert [function.name for function in functions if parameters(function) > MOST] == []

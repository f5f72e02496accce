"""Every library that the code imports is declared in pyproject.toml."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import ROOT

# Distributions whose import name is another one.
IMPORTED_AS = {
    "foxglove-sdk": "foxglove",
    "pillow": "PIL",
    "pytest-benchmark": "pytest_benchmark",
    "import-linter": "importlinter",
    "markdown-it-py": "markdown_it",
    "ruamel.yaml": "ruamel",
    "kiss-icp": "kiss_icp",
    "eclipse-zenoh": "zenoh",
    "protobuf": "google",
}
OURS = {"hectorscope", "slam_core", "tests", "benchmarks"}
FOLDERS = {
    "app": ("cluster", "dds", "parquet", "publish", "zenoh"),
    "slam_core": (),
    "tests": ("test", "check"),
    "benchmarks": ("test", "bench"),
    "docs": (),
}


def imported(folder: Path) -> Iterator[str]:
    """The top-level names of all imports below a folder, those inside of functions too."""
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from (alias.name.split(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                yield node.module.split(".")[0]


def declared(extras: tuple[str, ...]) -> set[str]:
    """The import names of the dependencies, and of some extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    requirements = [*project["dependencies"], *(r for e in extras for r in project["optional-dependencies"][e])]
    names = [re.split(r"[<>=\[ ]", requirement)[0] for requirement in requirements]
    return {IMPORTED_AS.get(name, name) for name in names}


@pytest.mark.parametrize(("folder", "extras"), FOLDERS.items())
def test_every_import_is_declared(folder: str, extras: tuple[str, ...]):
    """What is imported is of the standard library, of the project, or a dependency by its own name."""
    found = set(imported(ROOT / folder)) - OURS - set(sys.stdlib_module_names)
    assert not found - declared(extras)


def test_the_core_needs_numpy_and_numba_only():
    """slam_core imports numpy, numba, and llvmlite of numba."""
    assert set(imported(ROOT / "slam_core")) - set(sys.stdlib_module_names) - OURS <= {
        "numpy",
        "numba",
        "llvmlite",
    }

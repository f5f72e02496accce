"""The command line: in a process of its own, as a person calls it, or called here, which takes seconds less."""

import io
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout

import pytest

from hectorscope.cli.main import main

PATIENCE_S = 300.0
MISTAKE = 2
WIDE = {"COLUMNS": "100"}

Done = subprocess.CompletedProcess[str]


def hectorscope(*arguments: object) -> Done:
    """The command in a process of its own."""
    command = [sys.executable, "-m", "hectorscope.cli.main", *map(str, arguments)]
    wide = {**os.environ, **WIDE}
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, env=wide, check=False)


def called(*arguments: object) -> Done:
    """The same in this process: for what is not about processes. What escapes `main` fails the test."""
    given, out, errors = [*map(str, arguments)], io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(errors):
        patch.setenv("COLUMNS", WIDE["COLUMNS"])
        try:
            code = main(given)
        except SystemExit as end:  # of the parser, with its exit code
            assert isinstance(end.code, int)
            code = end.code
    return subprocess.CompletedProcess(given, code, out.getvalue(), errors.getvalue())


def refused(*arguments: object, by: Callable[..., Done] = called) -> str:
    """The one line on stderr of a command that must exit with 2 and without a traceback."""
    done = by(*arguments)
    assert done.returncode == MISTAKE, done.stderr
    assert "Traceback" not in done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith("hectorscope: ")]
    assert len(lines) == 1, done.stderr
    return lines[0]

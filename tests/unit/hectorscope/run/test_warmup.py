"""The kernels are ready before the first scan, and whoever waits for them is told."""

import subprocess
import sys

import pytest

from hectorscope.run import warmup
from tests.conftest import ROOT

# Prints every function of ours that is compiled, not loaded.
WATCHED = """
from tests import conftest
from hectorscope.run import warmup

class Compiled(warmup.event.Listener):
    def on_start(self, _):
        pass

    def on_end(self, compilation):
        if warmup.is_ours(compilation):
            print(compilation.data["dispatcher"].py_func.__qualname__)

warmup.listen("numba:compile", Compiled())
"""
EVERYTHING = "warmup.load_everything()"
TOLD = """
from hectorscope.run import warmup
from slam_core.slam import HectorSlam

def report(text, share=None):
    print(text, "" if share is None else share, sep="|", flush=True)

warmup.warm_up(report)
print("begins", flush=True)
slam = HectorSlam()
for stamp_ns in (0, 100_000_000):
    slam.step(warmup._scan(stamp_ns))
"""
# Prints what became of the pose, and every signature of a kernel that Python calls that the start did not load.
LOSES = """
import sys
from tests import conftest
from hectorscope.run import warmup
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from numba.core.dispatcher import Dispatcher
from slam_core.config import SlamConfig, with_value
from tests.integration.test_gap import ROOMS, Drive
from tests.integration.test_recovery import kidnapped

def loaded():
    modules = [module for name, module in sys.modules.items() if name.startswith("slam_core.")]
    kernels = {each for module in modules for each in vars(module).values() if isinstance(each, Dispatcher)}
    return {(kernel.py_func.__qualname__, signature) for kernel in kernels for signature in kernel.signatures}

warmup.warm_up(everything=True)
before, states = loaded(), []
for inertial, planar in ((True, False), (False, False), (True, True)):
    pipeline = Pipeline(Settings(with_value(SlamConfig(), "platform.planar", planar)))
    for item in kidnapped(inertial):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
            if pipeline.result is not None:
                states.append(pipeline.result.tracking)
assert Drive(*ROOMS).to_the_end().lost.any()
print(*(state for state in ("lost", "recovered") if state in states), *map(str, loaded() - before), sep="\\n")
"""
# Prints every kernel that Python code of ours calls and that is not loaded after the start.
MISSED = """
import ast, importlib, inspect, pkgutil
import hectorscope, slam_core
from numba.core.dispatcher import Dispatcher
from tests import conftest
from hectorscope.run import warmup

def called(node, names):
    \"\"\"By code that is not compiled itself.\"\"\"
    if any("njit" in ast.unparse(each) for each in getattr(node, "decorator_list", ())):
        return
    if isinstance(node, ast.Call):
        owner, _, name = ast.unparse(node.func).rpartition(".")
        yield getattr(names.get(owner), name, None) if owner else names.get(name)
    for inner in ast.iter_child_nodes(node):
        yield from called(inner, names)

warmup.load_everything()
found = [each.name for package in (slam_core, hectorscope)
         for each in pkgutil.walk_packages(package.__path__, package.__name__ + ".")]
# No run calls these: a simulation, what checks indices in compiled code, and eqs. (4) to (6) as tests read them.
apart = {"__main__", "simulation", "checked", "interpolate"}
found = [name for name in found if not apart & {*name.split(".")}]
modules = [importlib.import_module(name) for name in found]
kernels = {each for module in modules for each in called(ast.parse(inspect.getsource(module)), vars(module))
           if isinstance(each, Dispatcher)}
print(len(kernels), *(each.py_func.__name__ for each in kernels if not each.signatures))
"""
COLD_S = 900  # of a busy machine


def output(script: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Of a process of its own."""
    command = [sys.executable, "-c", script]
    env = {**warmup.os.environ, **environment}
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=COLD_S, text=True, env=env)


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> subprocess.CompletedProcess[str]:
    """What the very first start of all says: to its page on stdout, and on stderr."""
    return output(TOLD, NUMBA_CACHE_DIR=str(tmp_path_factory.mktemp("cold")))


@pytest.mark.slow
def test_the_first_scan_waits_for_its_own_kernels_only(told: subprocess.CompletedProcess[str]) -> None:
    """How far that is goes to the terminal and to the page, up to the whole; the match is compiled later."""
    first, later = told.stdout.split("begins\n")
    shares = [float(line.split("|")[1]) for line in first.splitlines() if not line.startswith("|")]
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert shares[-1] == 1.0
    assert "match_coarse_to_fine" not in first
    assert f"of {warmup.FIRST} functions (first start only)" in told.stderr
    assert later.startswith("Compiling fuse_part (first start only)|\n")  # what nobody else compiles so soon


def test_the_whole_is_told_where_the_helper_comes_to_the_last_function(monkeypatch: pytest.MonkeyPatch) -> None:
    """It does so at any time: after the last word that the start itself had, too."""
    told: list[float | None] = []
    monkeypatch.setattr(warmup._compiler, "report", lambda _text, share=None: told.append(share))
    monkeypatch.setattr(warmup._compiler, "_done", 0)
    with warmup._compiler.preparing(1):
        warmup._compiler._done += 1  # as for a line of the helper
    assert told == [1.0, None]


@pytest.mark.slow
def test_a_kernel_that_a_run_needs_later_is_told(told: subprocess.CompletedProcess[str]) -> None:
    """Each is named while it is compiled, and then the words are taken back."""
    later = told.stdout.split("begins\n")[1].splitlines()
    assert later
    assert [line == "|" for line in later] == [False, True] * (len(later) // 2)


def test_a_start_that_compiles_nothing_says_nothing() -> None:
    """Who has not waited needs no word, and nobody helps."""
    output("from tests import conftest; from hectorscope.run import warmup; warmup.warm_up()")
    again = output(f"from tests import conftest\n{TOLD.split('slam =', maxsplit=1)[0]}")
    assert again.stdout == "begins\n"
    assert again.stderr == ""


def test_a_helper_ends_with_who_began_it() -> None:
    """It stops when its input is closed, which the end of a process does."""
    helper = warmup.helper()
    helper.communicate()  # closes its input, as the end of this process would
    assert helper.returncode == 1


def test_the_second_start_compiles_nothing() -> None:
    """Every kernel that Python calls is kept; one that is not would be compiled at each start."""
    output(WATCHED + EVERYTHING)
    assert not output(WATCHED + EVERYTHING).stdout


def test_no_kernel_that_python_calls_is_missed() -> None:
    """A run would stop to compile it at the scan that needs it first."""
    count, *missed = output(MISSED).stdout.split()
    assert int(count) > 40
    assert not missed


def test_a_stream_that_loses_its_pose_compiles_nothing() -> None:
    """All is there before it begins, in a plane, too: a robot that is carried away compiles no new signature.

    Nor does one whose data breaks off for some seconds.
    """
    done = output(LOSES).stdout.splitlines()
    assert done[:2] == ["lost", "recovered"]
    assert not done[2:]

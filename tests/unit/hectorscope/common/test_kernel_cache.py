"""Where compiled kernels are kept."""

import os
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from hectorscope.common import kernel_cache
from hectorscope.common.kernel_cache import CacheError
from tests.cases import quick_first


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small tree with one kernel and one plain module."""
    for folder in ("slam_core", "hectorscope"):
        (tmp_path / folder).mkdir()
    (tmp_path / "slam_core/kernel.py").write_text("@njit\ndef f(x):\n    return x\n")
    (tmp_path / "hectorscope/plain.py").write_text("x = 1\n")
    monkeypatch.setattr(kernel_cache, "PACKAGES", (tmp_path / "slam_core", tmp_path / "hectorscope"))
    return tmp_path


def test_a_changed_kernel_has_another_folder(sources: Path):
    """Machine code of yesterday's kernel is never found again; other changes keep what is kernel_cache."""
    before = kernel_cache.fingerprint()
    (sources / "hectorscope/plain.py").write_text("x = 2\n")
    assert kernel_cache.fingerprint() == before
    (sources / "slam_core/kernel.py").write_text("@njit\ndef f(x):\n    return 2 * x\n")
    changed = kernel_cache.fingerprint()
    assert changed != before
    (sources / "slam_core/memory.py").write_text("@intrinsic\ndef get(_, array, i):\n    return load\n")
    assert kernel_cache.fingerprint() != changed


def test_any_changed_module_is_another_version(sources: Path):
    """What is pickled depends on classes that are not compiled."""
    before = kernel_cache.version()
    (sources / "hectorscope/plain.py").write_text("x = 2\n")
    assert kernel_cache.version() != before


def test_the_environment_s_choice_is_kept(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Who set NUMBA_CACHE_DIR keeps it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "elsewhere")
    kernel_cache.keep_compiled(sources / "caches")
    assert kernel_cache.os.environ["NUMBA_CACHE_DIR"] == "elsewhere"


@pytest.fixture
def unset(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No folder is named yet; what a test names is forgotten after it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "of the tests")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    return


def chosen() -> Path:
    """The folder that numba would use."""
    return Path(os.environ["NUMBA_CACHE_DIR"])


@pytest.mark.usefixtures("unset")
def test_the_checked_build_has_a_folder_of_its_own(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Kernels with bounds checks never stand in for those without, nor the other way round."""
    names = []
    for asked in ("0", "1"):
        monkeypatch.setenv("NUMBA_BOUNDSCHECK", asked)
        monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
        kernel_cache.keep_compiled(sources / "caches")
        names.append(chosen().name)
    assert names[1] == f"{names[0]}-checked"


@pytest.mark.usefixtures("unset")
def test_the_next_place_is_taken_where_one_cannot_be_written(sources: Path):
    """As without a home, or with one that is read only; the folder is for its owner alone."""
    (sources / "file").write_text("")
    kernel_cache.keep_compiled(sources / "file", sources / "caches")
    assert chosen() == sources / "caches" / kernel_cache.fingerprint()
    assert {stat.S_IMODE(each.stat().st_mode) for each in (chosen(), chosen().parent)} == {0o700}


@pytest.mark.usefixtures("unset")
def test_a_folder_that_others_could_write_is_closed(sources: Path):
    """What is loaded from it is run."""
    folder = sources / "caches" / kernel_cache.fingerprint()
    folder.mkdir(parents=True)
    folder.chmod(0o777)
    kernel_cache.keep_compiled(sources / "caches")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


@pytest.mark.usefixtures("unset")
def test_a_folder_of_somebody_else_is_not_used(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Without another place the message says why, and what to do."""
    monkeypatch.setattr(os, "getuid", lambda: 4711)
    with pytest.raises(CacheError, match=r"belongs to somebody else\): set NUMBA_CACHE_DIR"):
        kernel_cache.keep_compiled(sources / "caches")


@pytest.mark.usefixtures("unset")
def test_a_full_disk_is_not_used(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Neither is it where what is there already is all that is needed."""
    monkeypatch.setattr(kernel_cache, "NEEDED", 2**60)
    with pytest.raises(CacheError, match="No space left"):
        kernel_cache.keep_compiled(sources / "caches")


def test_without_a_home_the_temporary_folder_is_left(monkeypatch: pytest.MonkeyPatch):
    """As in a container whose user has no entry."""

    def nowhere() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", nowhere)
    (place,) = kernel_cache.cache_places()
    assert place.parent == Path(tempfile.gettempdir())


@pytest.mark.parametrize("damage", quick_first([b"\x80\x05]", b""], ids=["cut", "empty"]))
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_a_damaged_file_is_compiled_again(tmp_path: Path, kind: str, damage: bytes):
    """Of the index or the code: the program runs as at its first start."""
    script = tmp_path / "user.py"
    script.write_text(
        "import sys\nfrom pathlib import Path\n"
        "from hectorscope.common.kernel_cache import keep_compiled\n"
        "keep_compiled(Path(sys.argv[1]))\n"
        "from numba import njit\n"
        "@njit('f8(f8)', cache=True)\ndef twice(x):\n    return 2.0 * x\nprint(twice(2.0))\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, script, tmp_path / "caches"]
    for _ in range(2):
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
        assert (done.stdout, done.stderr) == ("4.0\n", "")
        files = list((tmp_path / "caches").rglob(f"*.{kind}"))
        assert files
        for file in files:
            file.write_bytes(damage)

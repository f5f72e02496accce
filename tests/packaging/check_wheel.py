"""Builds the wheel, installs it in an empty environment outside the checkout, and uses it there.

    python tests/packaging/check_wheel.py

It checks that the wheel brings exactly two import names, runs a bundled demo headless, serves the page, and runs
the example of docs/library.md. Run by `make wheel-check` and by the continuous integration.
"""

import os
import re
import subprocess
import sys
import tempfile
import urllib.request
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NAMES = {"hectorscope", "slam_core"}
TIMEOUT_S = 600
EXAMPLE = re.compile(r"```python\n(.*?)```", re.DOTALL)


def run(*command: str | Path, cwd: Path) -> str:
    """The output of a command; its errors are shown and end the check."""
    parts, env = [str(part) for part in command], clean(cwd)
    done = subprocess.run(parts, cwd=cwd, env=env, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))} failed with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def clean(cwd: Path) -> dict[str, str]:
    """The environment without a way to the checkout; compiled kernels go below `cwd`."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    caches = {"XDG_CACHE_HOME": str(cwd / "cache"), "NUMBA_CACHE_DIR": str(cwd / "kernels")}
    return {**kept, **caches, "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


def build(folder: Path) -> Path:
    """The wheel, made from the checkout."""
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", folder, ROOT, cwd=folder)
    (wheel,) = folder.glob("hectorscope-*.whl")
    return wheel


def check_names(wheel: Path) -> None:
    """Two import names and no other, both typed, with the page's files and the demos inside."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    assert tops == NAMES, f"the wheel has {sorted(tops)} at its top level, not {sorted(NAMES)}"
    files = ("py.typed", "exporters/report.html.jinja", "_demo_bags/arena.bag")
    for name in ("slam_core/py.typed", *(f"hectorscope/{file}" for file in files)):
        assert name in names, f"{name} is missing in the wheel"
    assert any(name.startswith("hectorscope/_static/") for name in names), "static/ is missing in the wheel"


def install(wheel: Path, folder: Path) -> Path:
    """The scripts of an empty environment with the wheel in it."""
    venv.create(folder / "venv", with_pip=True)
    scripts = folder / "venv" / "bin"
    run(scripts / "python", "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", wheel, cwd=folder)
    where = run(scripts / "python", "-I", "-c", "import slam_core; print(slam_core.__file__)", cwd=folder)
    assert str(folder) in where, f"slam_core comes from {where.strip()}, not from the new environment"
    return scripts


def check_demo(scripts: Path, folder: Path) -> None:
    """A bundled recording, headless."""
    code = "from hectorscope.cli.opening import demo_bag; print(demo_bag('arena'))"
    bag = run(scripts / "python", "-I", "-c", code, cwd=folder).strip()
    print(run(scripts / "hectorscope", "run", bag, "--out", folder / "out", cwd=folder).strip().splitlines()[-1])
    for name in ("trajectory.tum", "map.pgm", "map.npz", "metrics.json"):
        assert (folder / "out" / name).stat().st_size > 0, f"{name} was not written"


def check_page(scripts: Path, folder: Path) -> None:
    """The page of a demo, with its files; it ends when it is asked to."""
    command = [str(scripts / "hectorscope"), "demo", "--port", "0"]
    server = subprocess.Popen(command, cwd=folder, env=clean(folder), stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        url = next(found[0] for line in server.stdout if (found := re.search(r"http://\S+", line)))
        with urllib.request.urlopen(url, timeout=60) as answer:
            page = answer.read().decode()
        assert "<title>Hectorscope</title>" in page, "the page has another title"
        with urllib.request.urlopen(f"{url}static/hectorscope.css", timeout=60) as answer:
            assert answer.status == 200
        server.terminate()  # and not SIGINT, which a shell's background ignores
        assert server.wait(timeout=60) == 130, "the request to end did not end the server"
    finally:
        server.kill()


def check_library(scripts: Path, folder: Path) -> None:
    """The example of the documents."""
    found = EXAMPLE.search((ROOT / "docs" / "library.md").read_text(encoding="utf-8"))
    assert found is not None, "docs/library.md has no example"
    print(run(scripts / "python", "-I", "-c", found[1], cwd=folder).strip())


def main() -> None:
    """All of it."""
    with tempfile.TemporaryDirectory(prefix="hectorscope-wheel-") as made:
        folder = Path(made)
        wheel = build(folder)
        check_names(wheel)
        scripts = install(wheel, folder)
        check_library(scripts, folder)
        check_demo(scripts, folder)
        check_page(scripts, folder)
    print(f"{wheel.name}: installed and used outside of the checkout")


if __name__ == "__main__":
    main()

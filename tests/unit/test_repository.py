"""The house keeps its promises: what the documents say exists, and what exists is documented."""

import ast
import importlib
import importlib.util
import re
import subprocess
import tomllib
from pathlib import Path
from typing import get_args

import pytest
from packaging.requirements import Requirement

from hectorscope.cli.main import main
from hectorscope.common.registry import members
from slam_core.config import SlamConfig, Tier, leaves
from tests.conftest import ROOT

REGISTRIES = {"sources": "SOURCE", "views": "VIEW", "panels": "PANEL", "exporters": "EXPORTER"}
EQUATIONS = [f"({n})" for n in range(1, 21)]
SECTIONS = ["I", "III", "IV", "IV-A", "IV-B", "IV-C", "V", "V-A", "V-B", "VI-A", "VI-B", "VI-C"]


def read(name: str) -> str:
    """The text of a file of the project."""
    return (ROOT / name).read_text(encoding="utf-8")


def help_of(capsys: pytest.CaptureFixture[str], *command: str, flag: str = "--help") -> str:
    """What the program prints for --help, or another flag."""
    with pytest.raises(SystemExit):
        main([*command, flag])
    return capsys.readouterr().out


def commands(capsys: pytest.CaptureFixture[str]) -> list[str]:
    """Every subcommand that the program offers."""
    offered = re.search(r"\{([a-z,]+)\}", help_of(capsys))
    assert offered
    return offered[1].split(",")


# --------------------------------------------------------------------------------------------- command line


def test_every_command_is_documented(capsys: pytest.CaptureFixture[str]):
    """The README and docs/commands.md name each subcommand, and none that does not exist."""
    offered = commands(capsys)
    assert {"demo", "view", "live", "run", "inspect", "simulate"} <= set(offered)
    for document in ("README.md", "docs/commands.md"):
        named = re.findall(r"^\| `hectorscope (\w+)", read(document), re.MULTILINE)
        assert sorted(named) == sorted(offered), document


def test_every_flag_is_documented(capsys: pytest.CaptureFixture[str]):
    """docs/commands.md names each flag that is no setting, and none that does not exist."""
    shown = "".join(help_of(capsys, command) for command in commands(capsys))
    flags = {flag for flag in re.findall(r"(?<![\w-])--[a-z][a-z.-]*[a-z]", shown) if "." not in flag} - {"--help"}
    documented = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*[a-z]", read("docs/commands.md"))) - {"--help"}
    assert documented == flags


@pytest.mark.parametrize(("flag", "tiers"), [("--help", {"first", "basic"}), ("--help-all", set(get_args(Tier)))])
def test_every_setting_is_a_flag(capsys: pytest.CaptureFixture[str], flag: str, tiers: set[str]):
    """By its dotted name, whatever stands in front: --help has the basic ones alone, --help-all every one."""
    shown = help_of(capsys, "run", "some.bag", "--motion.acceleration", "2", flag=flag)
    listed = {leaf.name for leaf in leaves(SlamConfig()) if f"--{leaf.name.replace('_', '-')} " in shown}
    assert listed == {leaf.name for leaf in leaves(SlamConfig()) if leaf.param.tier in tiers}


def test_commands_of_the_readme_exist():
    """Each `make ...` that the documents speak of is a target of the Makefile."""
    targets = set(re.findall(r"^([a-z-]+):", read("Makefile"), re.MULTILINE))
    documents = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    named = {
        name for path in documents for name in re.findall(r"`make ([a-z-]+)", path.read_text(encoding="utf-8"))
    }
    assert named <= targets
    assert {"demo", "test", "check", "bench", "screenshots", "clean", "help"} <= targets


# ------------------------------------------------------------------------------------------------ documents


def test_every_setting_is_documented():
    """docs/configuration.md is what `make docs` would write today, and every setting has words of its own."""
    spec = importlib.util.spec_from_file_location("configuration", ROOT / "docs" / "configuration.py")
    assert spec and spec.loader
    generator = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generator)
    assert generator.document() == read("docs/configuration.md"), "run `make docs`"
    assert all(leaf.param.help for leaf in leaves(SlamConfig()))


def paper_rows() -> dict[str, tuple[list[str], list[str]]]:
    """Equation or section -> functions and tests, of docs/paper-map.md."""
    rows = {}
    for line in read("docs/paper-map.md").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 5 and (cells[0] in EQUATIONS or cells[0] in SECTIONS):
            named = [re.findall(r"`([^`]+)`", cell) for cell in cells]
            rows[cells[0]] = (named[2] + named[3], named[4])
    return rows


def test_the_paper_map_is_complete():
    """Each numbered equation and each section that describes a method has a row."""
    assert sorted(paper_rows()) == sorted(EQUATIONS + SECTIONS)


@pytest.mark.parametrize("place", EQUATIONS + SECTIONS)
def test_the_paper_map_points_at_what_exists(place: str):
    """The functions of the row can be imported; the tests of the row are in their files."""
    functions, tests = paper_rows()[place]
    assert functions and tests
    assert place.startswith("VI") or functions[0].startswith("slam_core.reference.")
    for function in functions:
        resolve(function)
    for test in tests:
        path, _, name = test.partition("::")
        assert name in functions_in(ROOT / path), test


def resolve(dotted: str) -> object:
    """The object of a name like slam_core.slam.HectorSlam.step."""
    parts = dotted.split(".")
    for depth in range(len(parts), 0, -1):
        name = ".".join(parts[:depth])
        files = (ROOT / top / Path(*parts[:depth]).with_suffix(".py") for top in ("", "app"))
        if any(file.is_file() for file in files):
            found = importlib.import_module(name)
            for attribute in parts[depth:]:
                found = getattr(found, attribute)
            return found
    raise AssertionError(f"{dotted} is in no module")


def functions_in(path: Path) -> set[str]:
    """Names of the functions of a file, without running it."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


def test_links_between_documents_lead_somewhere():
    """Each relative link and picture of the documents is a file of the project."""
    broken = []
    for path in [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "demo_bags").glob("*.md")]:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text(encoding="utf-8")):
            if "://" not in target and not (path.parent / target).exists():
                broken.append(f"{path.name}: {target}")
    assert not broken


# ------------------------------------------------------------------------------------------------- packaging


def test_constraints_fix_every_requirement():
    """constraints.txt holds names and versions only, and pins each requirement of pyproject.toml in its bounds."""
    lines = [line for line in read("constraints.txt").splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!-]+", line) for line in lines)
    pinned = {normal(name): version for name, version in (line.split("==") for line in lines)}
    project = tomllib.loads(read("pyproject.toml"))["project"]
    wanted = [*project["dependencies"], *(r for extra in project["optional-dependencies"].values() for r in extra)]
    for requirement in map(Requirement, wanted):
        assert requirement.specifier.contains(pinned[normal(requirement.name)]), requirement


def normal(name: str) -> str:
    """A distribution's name as the index compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def test_nothing_of_one_machine_is_committed():
    """No committed text holds a path of somebody's machine or the host of a package registry."""
    if not (ROOT / ".git").exists():
        pytest.skip("no git checkout: what is committed cannot be told")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    homes = "|".join(("root", "home/[a-z]", "work", "Users", "opt"))
    hosts = "|".join((r"pypi\." + "org", "python" + "hosted", r"npmjs\." + "org", r"ghcr\." + "io"))
    private = re.compile(rf"(?<![\w.$}}/-])/({homes})/|file:/{{3}}\w|{hosts}")
    found = []
    for name in filter(None, listed.split("\0")):
        path = ROOT / name
        if path.is_file() and b"\0" not in (content := path.read_bytes()):
            found += [f"{name}: {hit[0]}" for hit in private.finditer(content.decode("utf-8", "replace"))]
    assert not found


# ------------------------------------------------------------------------------------------------ registries


@pytest.mark.parametrize(("folder", "attribute"), REGISTRIES.items())
def test_every_file_of_a_folder_is_registered(folder: str, attribute: str):
    """Each file that is no helper brings the attribute by which its folder finds it."""
    package = importlib.import_module(f"hectorscope.{folder}")
    paths = (ROOT / "app" / "hectorscope" / folder).glob("*.py")
    files = [path.stem for path in paths if not path.stem.startswith("_")]
    assert files
    assert len(members(package, attribute)) == len(files)


def test_scripts_call_what_the_page_has() -> None:
    """Each function of `hectorscope` that benchmarks and tests call in the page is named in static/."""
    page = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "static").rglob("*.js"))
    scripts = [path for folder in ("benchmarks", "tests") for path in (ROOT / folder).rglob("*.py")]
    called = {
        (name, path.name)
        for path in scripts
        for name in re.findall(r"\bhectorscope\??\.(\w+)(?=\??\.?\()", path.read_text(encoding="utf-8"))
    }
    assert {"levels", "camera"} <= {name for name, _ in called}
    assert not [each for each in sorted(called) if not re.search(rf"\b{each[0]}\b", page)]

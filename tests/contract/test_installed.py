"""A release as a maintainer makes it and a user installs it: a tag, both distributions, an environment of its own.

What is committed is released, so a change that is not committed is not seen here.
"""

import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
from email.parser import HeaderParser
from pathlib import Path

import pytest

from tests.commands.page_commands import command_of
from tests.contract.source_tree import ROOT
from tests.until import EVER

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (ROOT / ".git").exists(), reason="files without a history have no tag"),
]

VERSION = "98.7.6"
SCRIPTS = tuple(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"])
MADE = {"PKG-INFO", "setup.cfg"}
"""What a source distribution has beside the files of the checkout, and a folder of `.egg-info`."""
STUDY = """
name = "draws"
commands = ["firmware-sim draw vibrator --seed {seed} --out drawn.toml --json drawn.json"]
seeds.count = 2
[figures]
modes = {file = "drawn.json", path = "drawn.modes.value"}
"""
COMMANDS = (
    "vibrostage vibrator example-config > rig.toml",
    "vibrostage calibrate vibrator --config rig.toml --out model.h5",
    "vibrostage vibrator run --config rig.toml --model model.h5 --reference chirp:40:90:5 --shots 1 --out RUN",
    "vibrostage vibrator report RUN --json report.json",
    "vibrostage stage example-config > stage.toml",
    "vibrostage cell example-cell > cell.toml",
    "vibrostage cell robot-files abb --config cell.toml --out ABB",
    "vibrostage cell example-pocket > POCKET.json",
    "vibrostage plan POCKET.json --planner sequential --out PATH.json --report plan.html",
    "vibrostage sim draw stage --seed 1 --out drawn.toml",
    "vibrostage study run STUDY.toml --out DRAWS",
    "vibrostage study report DRAWS",
)
"""At least one of each word; they read the package's own data: pages, robots, the controllers' programs."""


@pytest.fixture(scope="module")
def released(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Tag a clone, and return the source distribution that is built of it."""
    clone = tmp_path_factory.mktemp("release") / "clone"
    for words in (["clone", "-q", str(ROOT), str(clone)], ["-C", str(clone), "tag", f"v{VERSION}"]):
        subprocess.run(["git", *words], check=True, timeout=EVER)
    return _built("sdist", clone, "*.tar.gz")


@pytest.fixture(scope="module")
def environment(released: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the wheel that is built of the unpacked source distribution; return the folder of its programs.

    What it depends on is taken from where the tests run, the checkout that is installed there excepted.
    """
    place = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(released) as archive:
        archive.extractall(place, filter="data")
    (unpacked,) = place.iterdir()
    wheel = _built("wheel", unpacked, "*.whl")
    made = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", str(made)], check=True, timeout=EVER)
    python = made / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", wheel]
    subprocess.run([*map(str, install)], check=True, timeout=EVER)
    its = Path(sysconfig.get_path("purelib", vars={"base": str(made), "platbase": str(made)}))
    (its / "dependencies.pth").write_text(sysconfig.get_path("purelib"))  # a .pth of an editable install is not read
    return python.parent


def _built(kind: str, source: Path, made: str) -> Path:
    code = f"from setuptools.build_meta import build_{kind}; build_{kind}('dist')"
    done = subprocess.run([sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (found,) = (source / "dist").glob(made)
    return found


def _run(programs: Path, words: tuple[str, ...], folder: Path) -> subprocess.CompletedProcess[str]:
    bare = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    line = [str(programs / words[0]), *words[1:]]
    return subprocess.run(line, cwd=folder, env=bare, capture_output=True, text=True, check=False)


def test_the_source_distribution_has_every_committed_file_and_no_other(released: Path) -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=released.parents[1], capture_output=True, text=True, check=True)
    with tarfile.open(released) as archive:
        names = [each.name for each in archive.getmembers() if each.isfile()]
        about = archive.extractfile(f"vibrostage-{VERSION}/PKG-INFO")
        assert about is not None
        said = HeaderParser().parsestr(about.read().decode())
    packed = {name.partition("/")[2] for name in names}
    assert {name for name in packed - MADE if ".egg-info/" not in name} == set(listed.stdout.splitlines())
    assert (said["Version"], said.get_all("License-File")) == (VERSION, ["LICENSE"])


@pytest.mark.parametrize("program", SCRIPTS)
def test_an_installed_program_says_the_tag_and_its_help(program: str, environment: Path, tmp_path: Path) -> None:
    said = _run(environment, (program, "--version"), tmp_path).stdout
    assert re.fullmatch(rf"vibrostage {re.escape(VERSION)}, Python [\d.]+\n", said)
    assert _run(environment, (program, "--help"), tmp_path).returncode == 0


def test_each_word_of_the_umbrella_works_from_an_installed_wheel(environment: Path, tmp_path: Path) -> None:
    (tmp_path / "STUDY.toml").write_text(STUDY)
    for line in COMMANDS:
        command = command_of(line)
        done = _run(environment, command.words, tmp_path)
        assert done.returncode == 0, f"{line}\n{done.stderr}"
        if command.into:
            (tmp_path / command.into).write_text(done.stdout)
    for name in ("RUN/report.html", "ABB/vibrostage_talk.mod", "plan.html", "DRAWS/report.html"):
        assert (tmp_path / name).is_file(), name

"""What a distribution holds: of the source all that makes a wheel, of the wheel every file of every package."""

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.parser import HeaderParser
from pathlib import Path

import pytest

from tests.contract.source_tree import PACKAGES, ROOT

BESIDE = ("pyproject.toml", "MANIFEST.in", "README.md", "LICENSE", "CHANGELOG.md", "packaging")
SCRIPTS: dict[str, str] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
EXAMPLES = {"vibractl": (("example-config",),), "stagectl": (("example-cell",), ("example-pocket",))}
"""What reads the package's own data."""
BUILD_SOURCE = "from setuptools.build_meta import build_sdist; build_sdist('dist')"
BUILD = "from setuptools.build_meta import build_wheel; build_wheel('dist')"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a source distribution, from a copy without a history (setuptools leaves traces), and unpack it."""
    place = tmp_path_factory.mktemp("source")
    for name in (*PACKAGES, *BESIDE):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, place / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, place)
    made = _built(BUILD_SOURCE, place, "*.tar.gz")
    with tarfile.open(made) as archive:
        archive.extractall(place / "unpacked", filter="data")
    (unpacked,) = (place / "unpacked").iterdir()
    return unpacked


@pytest.fixture(scope="module")
def wheel(source: Path) -> zipfile.ZipFile:
    """Build one from the source distribution, as an installer does with that."""
    return zipfile.ZipFile(_built(BUILD, source, "*.whl"))


def _built(code: str, place: Path, made: str) -> Path:
    done = subprocess.run([sys.executable, "-c", code], cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (found,) = (place / "dist").glob(made)
    return found


def test_files_without_a_history_have_a_version(source: Path, wheel: zipfile.ZipFile) -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools_scm"]["fallback_version"]
    assert source.name == f"vibrostage-{version}"
    assert f"vibrostage-{version}.dist-info/METADATA" in wheel.namelist()


def test_files_for_a_lab_pc_are_in_the_wheel(wheel: zipfile.ZipFile) -> None:
    packed = {tuple(name.split("/")[-2:]) for name in wheel.namelist() if ".data/data/share/vibrostage/" in name}
    assert packed == {(file.parent.name, file.name) for file in (ROOT / "packaging").glob("*/*")}


def test_every_file_of_every_package_is_in_the_wheel(wheel: zipfile.ZipFile) -> None:
    there = {str(file.relative_to(ROOT)) for package in PACKAGES for file in _files(ROOT / package)}
    packed = {name for name in wheel.namelist() if not name.split("/")[0].endswith((".dist-info", ".data"))}
    assert packed == there


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_says_to_type_checkers_that_it_is_typed(package: str, wheel: zipfile.ZipFile) -> None:
    assert f"{package}/py.typed" in wheel.namelist()
    about = next(name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    assert "Typing :: Typed" in HeaderParser().parsestr(wheel.read(about).decode()).get_all("Classifier", [])


@pytest.fixture(scope="module")
def installed(wheel: zipfile.ZipFile, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Unpack it outside of the checkout, as an installer does with one that has only Python in it."""
    place = tmp_path_factory.mktemp("installed")
    wheel.extractall(place)
    return place


@pytest.mark.parametrize("script", SCRIPTS)
def test_each_program_works_outside_of_the_checkout(script: str, installed: Path, tmp_path: Path) -> None:
    module, _, function = SCRIPTS[script].partition(":")
    code = (
        f"import sys, {module} as program; assert program.__file__.startswith({str(installed)!r}), program.__file__; "
        f"sys.argv = [{script!r}, *sys.argv[1:]]; sys.exit(program.{function}())"
    )
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    for words in (("--version",), ("--help",), *EXAMPLES.get(script, ())):
        done = subprocess.run(
            [sys.executable, "-c", code, *words],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout


def _files(package: Path) -> list[Path]:
    return [file for file in package.rglob("*") if file.is_file() and "__pycache__" not in file.parts]

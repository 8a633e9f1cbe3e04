"""What a wheel holds: every file of every package, types and data files among them, and nothing beside."""

import shutil
import subprocess
import sys
import zipfile
from email.parser import HeaderParser
from pathlib import Path

import pytest

from tests.contract.source_tree import PACKAGES, ROOT

BESIDE = ("pyproject.toml", "README.md", "LICENSE")
BUILD = "from setuptools.build_meta import build_wheel; build_wheel('dist')"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """Build one, from a copy: setuptools leaves its traces where it builds."""
    place = tmp_path_factory.mktemp("wheel")
    for package in PACKAGES:
        shutil.copytree(ROOT / package, place / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in BESIDE:
        shutil.copy(ROOT / name, place)
    done = subprocess.run([sys.executable, "-c", BUILD], cwd=place, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (made,) = (place / "dist").glob("*.whl")
    return zipfile.ZipFile(made)


def test_every_file_of_every_package_is_in_the_wheel(wheel: zipfile.ZipFile) -> None:
    there = {str(file.relative_to(ROOT)) for package in PACKAGES for file in _files(ROOT / package)}
    packed = {name for name in wheel.namelist() if not name.split("/")[0].endswith(".dist-info")}
    assert packed == there


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_says_to_type_checkers_that_it_is_typed(package: str, wheel: zipfile.ZipFile) -> None:
    assert f"{package}/py.typed" in wheel.namelist()
    about = next(name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    assert "Typing :: Typed" in HeaderParser().parsestr(wheel.read(about).decode()).get_all("Classifier", [])


def _files(package: Path) -> list[Path]:
    return [file for file in package.rglob("*") if file.is_file() and "__pycache__" not in file.parts]

"""Folders of a package build on each other one way: whoever changes one can tell which others may notice."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.contract.source_tree import ROOT, sources, tree


def _folder(module: str) -> str:
    """Return the folder that a module is in, with dots; a package is its own."""
    return module if (ROOT / module.replace(".", "/")).is_dir() else module.rpartition(".")[0]


def _imported(file: Path, package: str) -> set[str]:
    """Return the folders of a package from which a file imports."""
    found = set()
    for node in ast.walk(tree(file)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == package:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}".replace(".", "/")
                is_module = (ROOT / f"{whole}.py").is_file() or (ROOT / whole).is_dir()
                found.add(_folder(whole.replace("/", ".") if is_module else str(node.module)))
    return found


def folders(package: str) -> dict[str, set[str]]:
    """Return for each folder of a package those that it imports from."""
    found: dict[str, set[str]] = {}
    for file in sources(package):
        here = ".".join(file.relative_to(ROOT).parent.parts)
        found.setdefault(here, set()).update(_imported(file, package) - {here})
    return found


@pytest.mark.parametrize("package", ["ctlblocks", "rigkit", "stagectl", "calibration"])
def test_folders_import_each_other_one_way(package: str) -> None:
    try:
        TopologicalSorter(folders(package)).prepare()
    except CycleError as fault:
        pytest.fail(" -> ".join(reversed(fault.args[1])))


def test_a_cycle_is_seen() -> None:
    with pytest.raises(CycleError):
        TopologicalSorter({"a": {"b"}, "b": {"a"}}).prepare()

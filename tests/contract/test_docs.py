"""What the house rules say of every file: its size, its words and its imports.

Ruff checks that docstrings are there and well formed.  Here: that a public function with array arguments says their
shape, under Parameters argument by argument and with a unit ("any unit" and "1" are units), or in its prose; that what
is documented exists; that examples run.  Not looked at: `process`, whose arguments are the ports, and kernels, whose
arguments are those of the block that calls them.
"""

import ast
import doctest
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from rigkit.config import Section, example
from rigkit.config_reference import reference
from rigkit.study.file import Figure, StudyFile
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import FOLDERS, PACKAGES, ROOT, Definition, definitions, imports, sources, tree
from tests.until import EVER
from vibractl.config import RigConfig

LONGEST_FILE = 300
LONGEST_FUNCTION = 40
CONTRACT_LINES = 1000

DEVICES = {"sounddevice", "can", "serial", "socket"}
EDGES = re.compile(
    r"firmware_sim/.*|rigkit/(service/sockets|relay/bus)\.py|vibractl/audio\.py|stagectl/link/(bus|slcan|robot_\w+)\.py|"
    r".*/__main__\.py"
)

_ENTRY = re.compile(r"^(\w+(?:, \w+)*) : (.+(?:\n +.+)*)", re.MULTILINE)
_SHAPE = re.compile(
    r"\((?:\w|\.{3})[^()]*,[^()]*\)|\(\)|(?:same|any) shape|broadcast|as long as|(?:shape|length) of"
)  # (frames, width), (..., joints)
_UNIT = re.compile(rf"(?:{_SHAPE.pattern})[^,]*,\s+\S|any unit")
_NEEDS_NO_UNIT = re.compile(r"\b(?:int|bool|integer|indices)\b")


@pytest.fixture(scope="module", autouse=True)
def _each_file_is_parsed_once() -> Iterator[None]:
    yield
    tree.cache_clear()


def test_a_file_has_at_most_300_lines() -> None:
    long = {str(file.relative_to(ROOT)): len(file.read_text().splitlines()) for file in sources(*FOLDERS)}
    assert {name: lines for name, lines in long.items() if lines > LONGEST_FILE} == {}


def test_a_function_fits_on_a_screen() -> None:
    """40 lines, its docstring not counted."""
    lines = {str(each): _length(each.node) for each in definitions(*FOLDERS)}
    assert {name: length for name, length in lines.items() if length > LONGEST_FUNCTION} == {}


def test_the_block_contract_stays_small() -> None:
    assert sum(len(file.read_text().splitlines()) for file in sources("ctlblocks")) < CONTRACT_LINES


def test_an_array_argument_is_documented_with_its_shape_and_unit() -> None:
    assert [fault for each in definitions(*PACKAGES) for fault in _undocumented_arrays(each)] == []


def test_a_returned_array_is_documented_with_its_shape() -> None:
    """By the word shape in the docstring, since many say it in their first line."""
    silent = [
        str(each)
        for each in definitions(*PACKAGES)
        if each.is_public and _is_array(each.node.returns) and not _SHAPE.search(_words(each))
    ]
    assert silent == []


def test_a_documented_parameter_exists() -> None:
    invented = [
        f"{each}: {sorted(extra)}"
        for each in definitions(*PACKAGES)
        if (extra := set(_parameters(ast.get_docstring(each.node) or "")) - _arguments(each.node))
    ]
    assert invented == []


def test_a_documented_parameter_of_a_class_exists() -> None:
    invented = [
        f"{file.relative_to(ROOT)} {node.name}: {sorted(extra)}"
        for file in sources(*PACKAGES)
        for node in tree(file).body
        if isinstance(node, ast.ClassDef)
        if (extra := set(_parameters(ast.get_docstring(node) or "")) - _settable(node))
    ]
    assert invented == []


@pytest.mark.parametrize("package", PACKAGES)
def test_the_examples_in_docstrings_run(package: str) -> None:
    failed = [name for name in _with_examples(package) if doctest.testmod(importlib.import_module(name)).failed]
    assert failed == []


def test_the_import_contracts_hold() -> None:
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 0, done.stdout


def test_devices_and_sockets_are_imported_at_the_edges_only_by_text_as_well() -> None:
    """import-linter sees statements; this sees `import_module("sounddevice")` too."""
    inside = [file for file in sources(*PACKAGES) if not EDGES.fullmatch(str(file.relative_to(ROOT)))]
    found = [
        f"{file.relative_to(ROOT)}:{line} {name}"
        for file in inside
        for line, name in imports(file)
        if name.split(".")[0] in DEVICES
    ]
    assert found == []


def test_the_block_contract_needs_numpy_and_soundfile_and_nothing_else() -> None:
    """An import contract can only forbid what it names."""
    allowed = {"numpy", "soundfile", "ctlblocks", *sys.stdlib_module_names}
    found = {name.split(".")[0] for file in sources("ctlblocks") for _, name in imports(file)}
    assert found - allowed == set()


def test_every_name_in_the_list_of_symbols_is_in_its_file() -> None:
    rows = [
        line.split(" | ") for line in (ROOT / "docs/symbols.md").read_text().splitlines() if line.endswith(".py` |")
    ]
    missing = [
        f"{name} in {row[-1]}"
        for row in rows
        for name in re.findall(r"`(?:\w+\.)*(\w+)`", row[-3])
        if not re.search(rf"\b{name}\b", (ROOT / row[-1].strip("` |")).read_text())
    ]
    assert len(rows) > 20
    assert missing == []


def test_the_rig_files_in_the_docs_are_those_the_programs_print() -> None:
    """`make docs` writes them."""
    for name, model in (("rig", RigConfig), ("stage", StageConfig), ("cell", CellConfig)):
        assert (ROOT / f"docs/{name}.toml").read_text() == example(model), f"docs/{name}.toml: make docs"


@pytest.mark.parametrize(
    ("page", "name", "model"),
    [
        ("rig", "rig.toml", RigConfig),
        ("stage", "stage.toml", StageConfig),
        ("cell", "cell.toml", CellConfig),
        ("study", "STUDY.toml", StudyFile),
        ("figure", "[figures.NAME]", Figure),
    ],
)
def test_the_reference_of_a_rig_file_in_the_docs_is_up_to_date(page: str, name: str, model: type[Section]) -> None:
    """`make docs` writes it."""
    there = (ROOT / "docs/config-reference" / f"{page}.md").read_text(encoding="utf-8")
    assert there == reference(model, name), f"docs/config-reference/{page}.md: make docs"


def _length(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    assert node.end_lineno is not None
    words = node.body[0] if ast.get_docstring(node) is not None else None
    in_words = words.end_lineno - words.lineno + 1 if words is not None and words.end_lineno else 0
    return node.end_lineno - node.lineno + 1 - in_words


def _undocumented_arrays(each: Definition) -> Iterator[str]:
    if not each.is_public or each.node.name == "process" or each.file.stem.endswith("_kernel"):
        return
    words = _words(each)
    entries = _parameters(words)
    for argument in each.node.args.posonlyargs + each.node.args.args + each.node.args.kwonlyargs:
        if not _is_array(argument.annotation):
            continue
        entry = entries.get(argument.arg, "")
        if not entry and not _SHAPE.search(words):
            yield f"{each}: {argument.arg} is not documented"
        elif entry and not _SHAPE.search(entry):
            yield f"{each}: {argument.arg} has no shape"
        elif entry and not _UNIT.search(entry) and not _NEEDS_NO_UNIT.search(entry):
            yield f"{each}: {argument.arg} has no unit"


def _words(each: Definition) -> str:
    words = ast.get_docstring(each.node) or ""
    return words if each.owner is None else f"{words}\n\n{ast.get_docstring(each.owner) or ''}"


def _parameters(docstring: str) -> dict[str, str]:
    """Read the entries "name : what" of the section Parameters; several names may share one."""
    parts = re.split(r"^(\w[\w ]*)\n-+$", docstring, flags=re.MULTILINE)
    sections = dict(zip(parts[1::2], parts[2::2], strict=True))
    entries = _ENTRY.findall(sections.get("Parameters", ""))
    return {name: text for names, text in entries for name in names.split(", ")}


def _arguments(node: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
    every = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs, node.args.vararg, node.args.kwarg]
    return {argument.arg for argument in every if argument is not None}


def _settable(node: ast.ClassDef) -> set[str]:
    """Find what a class is made with: the arguments of `__init__`, or the fields of a record."""
    fields = [item.target for item in node.body if isinstance(item, ast.AnnAssign)]
    names = {field.id for field in fields if isinstance(field, ast.Name)}
    for item in node.body:
        if isinstance(item, ast.FunctionDef) and item.name in {"__init__", "__new__"}:
            names |= _arguments(item)
    return names


def _is_array(annotation: ast.expr | None) -> bool:
    text = ast.unparse(annotation) if annotation is not None else ""
    return re.search(r"\bndarray\b", text) is not None and not text.startswith(("Callable", "tuple", "list", "dict"))


def _with_examples(package: str) -> Iterator[str]:
    for file in (each for each in sources(package) if ">>> " in each.read_text()):
        parts = file.relative_to(ROOT).with_suffix("").parts
        if parts[-1] != "__main__":
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts)

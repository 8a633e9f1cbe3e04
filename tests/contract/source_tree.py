"""The project's own source, as syntax trees, for the suites that hold for every file."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("ctlblocks", "rigkit", "vibractl", "stagectl", "calibration", "firmware_sim", "vibrostage")
FOLDERS = (*PACKAGES, "tests", "benchmarks", "examples")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Definition:
    """A function or method: where it stands, and the class around it if there is one."""

    file: Path
    node: Function
    owner: ast.ClassDef | None

    def __str__(self) -> str:
        owner = f"{self.owner.name}." if self.owner else ""
        return f"{self.file.relative_to(ROOT)}:{self.node.lineno} {owner}{self.node.name}"

    @property
    def is_public(self) -> bool:
        """Whether others are meant to call it."""
        return not any(name.startswith("_") for name in (self.node.name, self.owner.name if self.owner else "x"))


def sources(*folders: str) -> list[Path]:
    """Find the Python files of `folders`."""
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


@cache
def tree(file: Path) -> ast.Module:
    """Parse a file, once: whoever has looked at all of them clears this cache, of a few hundred MB."""
    return ast.parse(file.read_text(encoding="utf-8"), str(file))


def definitions(*folders: str) -> Iterator[Definition]:
    """Find every function and method of `folders`, but not functions within functions."""
    for file in sources(*folders):
        for node in tree(file).body:
            if isinstance(node, Function):
                yield Definition(file, node, None)
            elif isinstance(node, ast.ClassDef):
                yield from (Definition(file, item, node) for item in node.body if isinstance(item, Function))


def imports(file: Path) -> Iterator[tuple[int, str]]:
    """Find what a file imports: the line and the full name, whether by a statement or by a name given as text."""
    for node in ast.walk(tree(file)):
        match node:
            case ast.Import():
                yield from ((node.lineno, alias.name) for alias in node.names)
            case ast.ImportFrom(module=str(module), level=0):
                yield node.lineno, module
            case ast.Call(args=[ast.Constant(value=str(name)), *_]) if _called(node) in {"import_module", "resolve"}:
                yield node.lineno, name.partition(":")[0]


def _called(call: ast.Call) -> str:
    return ast.unparse(call.func).rpartition(".")[2]

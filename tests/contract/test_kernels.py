"""What the house rules say of compiled kernels: few arguments, and types that are said, so that mypy looks at calls;
kept on disk by the project's own `njit`, and made of nothing whose changes that would not see.
"""  # noqa: D205, D400

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from types import CodeType, ModuleType
from typing import Any

import numpy as np
from numba.extending import is_jitted

from tests.contract.source_tree import FOLDERS, PACKAGES, ROOT, Definition, definitions, sources, tree

LONG = {f"stagectl/robot/milling/force_{name}_kernel.py" for name in ("box", "set")} | {
    "stagectl/robot/milling/force_kernel.py"
}
"""Of the force from torques: what they share is in arrays side by side, which are no record."""
MOST_ARGUMENTS = 8
"""More are fields of a record, or ports side by side in a tuple."""


def kernels() -> list[Definition]:
    """Find what numba compiles."""
    found = definitions(*PACKAGES)
    return [each for each in found if any("njit" in ast.unparse(by) for by in each.node.decorator_list)]


def test_kernels_are_kept_by_the_projects_own_decorator() -> None:
    """Numba's own does not see that a kernel of another file, or a constant, has changed."""
    of_numba = [
        file for file in sources(*FOLDERS) if re.search(r"^\s*(from|import) numba\b", file.read_text("utf-8"), re.M)
    ]
    inside = [file for file in of_numba if file.relative_to(ROOT).parts[0] in PACKAGES]
    assert [file.relative_to(ROOT).as_posix() for file in inside] == ["rigkit/compiled.py"]
    nodes = [(file, node) for file in of_numba for node in ast.walk(tree(file)) if isinstance(node, ast.FunctionDef)]
    kept = [file.name for file, node in nodes if any("cache=True" in ast.unparse(by) for by in node.decorator_list)]
    assert kept == []
    assert {str(each) for each in kernels() if "cache=True" not in ast.unparse(each.node.decorator_list[0])} == set()


PLAIN = (bool, int, float, str, np.generic, np.dtype)
"""What `rigkit.compiled.stamp` sees every change of, with kernels, and tuples and arrays of them."""


def _odd(value: Any, names: set[str]) -> Iterator[str]:
    """Return what is not plain of a value that a kernel names, and of the names in it if that is a module of ours."""
    match value:
        case ModuleType():
            if value.__name__.split(".")[0] in PACKAGES:
                for name in names & set(vars(value)):
                    yield from (f"{name}: {odd}" for odd in _odd(vars(value)[name], names))
        case tuple():
            for each in value:
                yield from _odd(each, names)
        case np.ndarray():
            yield from _odd(value.dtype, names)
        case _ if not isinstance(value, PLAIN) and not is_jitted(value):
            yield repr(value)


def _names(code: CodeType) -> set[str]:
    within = [_names(each) for each in code.co_consts if isinstance(each, CodeType)]
    return set(code.co_names).union(*within)


def test_kernels_are_made_of_kernels_and_plain_values() -> None:
    seen = 0
    for each in kernels():
        module = import_module(".".join(each.file.relative_to(ROOT).with_suffix("").parts))
        function = getattr(module, each.node.name).py_func
        names = _names(function.__code__)
        odd = {name: list(_odd(vars(module)[name], names)) for name in names & set(vars(module))}
        assert {name: what for name, what in odd.items() if what} == {}, str(each)
        assert function.__closure__ is None, str(each)
        seen += len(odd)
    assert seen > len(kernels())


def test_a_kernel_has_few_arguments() -> None:
    assert kernels()
    long = {
        str(each): len(each.node.args.args) for each in kernels() if each.file.relative_to(ROOT).as_posix() not in LONG
    }
    assert {name: count for name, count in long.items() if count > MOST_ARGUMENTS} == {}


def test_a_kernels_arguments_and_results_have_types() -> None:
    untyped = [
        str(each)
        for each in kernels()
        if each.node.returns is None or any(argument.annotation is None for argument in each.node.args.args)
    ]
    assert untyped == []


def test_nothing_of_the_product_asks_mypy_to_overlook_missing_types() -> None:
    asked = re.compile(r"type: ignore\[[^\]]*no-untyped-def")
    files = list(sources(*PACKAGES))
    assert [str(file.relative_to(ROOT)) for file in files if asked.search(file.read_text(encoding="utf-8"))] == []

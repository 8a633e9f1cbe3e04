"""What the house rules say of compiled kernels: few arguments, and types that are said, so that mypy looks at calls."""

import ast
import re

from tests.contract.source_tree import PACKAGES, ROOT, Definition, definitions, sources

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

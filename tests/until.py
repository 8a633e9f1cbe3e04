"""Waiting for another thread or process, however slow the machine is; a wait that fails says for what it waited."""

import ast
import inspect
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from types import FunctionType
from typing import Any

EVER = 300.0
"""s after which something is held never to happen: for hung programs, not a measure of any speed."""
_PAUSE = threading.Event()


def until(true: Callable[[], object], seconds: float = EVER) -> None:
    """Return when `true` says so; fail after so long that it never will, with its text and what was there."""
    deadline = time.monotonic() + seconds
    while not true():
        if time.monotonic() >= deadline:
            text, there = described(true)
            values = "".join(f"\n  {name} was {value}" for name, value in there)
            raise AssertionError(f"within {seconds:g} s it has not come to pass that\n  {text}{values}")
        _PAUSE.wait(0.002)


def described(true: Callable[[], object]) -> tuple[str, list[tuple[str, str]]]:
    """Return a condition's text, and the text and value of each thing in it that is looked at."""
    expression = _expression(true)
    if expression is None or not isinstance(true, FunctionType):
        return getattr(true, "__qualname__", repr(true)), []
    there = [(ast.unparse(part), _value(part, true)) for part in _looked_at(expression)]
    return ast.unparse(expression), list(dict.fromkeys(there))


def _expression(true: Callable[[], object]) -> ast.expr | None:
    """Return what a lambda on lines of its own returns; None where it cannot be told."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(true)))
    except (OSError, TypeError, SyntaxError):
        return None
    found = [node.body for node in ast.walk(tree) if isinstance(node, ast.Lambda) and not node.args.args]
    return found[0] if len(found) == 1 else None


def _looked_at(part: ast.AST) -> Iterator[ast.expr]:
    """Find names with their attributes and subscripts, and methods called without arguments: the largest of each."""
    if isinstance(part, ast.Call) and isinstance(part.func, ast.Name):
        for argument in part.args:
            yield from _looked_at(argument)
    elif isinstance(part, ast.Name | ast.Attribute | ast.Subscript) or (isinstance(part, ast.Call) and not part.args):
        yield part
    elif not isinstance(part, ast.GeneratorExp | ast.ListComp | ast.Lambda):
        for child in ast.iter_child_nodes(part):
            yield from _looked_at(child)


def _value(part: ast.expr, true: FunctionType) -> str:
    """Evaluate a part where the condition stands; it may fail, which is a finding as well."""
    closure = inspect.getclosurevars(true)
    names: dict[str, Any] = true.__globals__ | dict(closure.nonlocals)
    try:
        return repr(eval(compile(ast.Expression(part), "<condition>", "eval"), names))  # the test's own text
    except Exception as fault:
        return f"not to be had: {fault!r}"

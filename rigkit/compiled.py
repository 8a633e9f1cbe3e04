"""Numba's `njit` for this project's kernels: what it keeps on disk bears a stamp of all that was compiled into it.

Numba compares the text of a function's own file alone, but kernels that it calls and constants of other modules are
compiled into its machine code as well: after an upgrade in place, numba's own decorator would run what is old.
"""

import types
from collections.abc import Callable, Iterator
from contextlib import suppress
from glob import escape
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba
import numpy as np
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.extending import is_jitted

Function = TypeVar("Function", bound=Callable[..., Any])


def njit(
    *,
    cache: bool = False,
    nogil: bool = False,
    error_model: Literal["python", "numpy"] = "python",
    fastmath: bool | set[str] = False,
    inline: Literal["never", "always"] = "never",
) -> Callable[[Function], Function]:
    """Compile a function as `numba.njit` does; with `cache`, kept on disk until anything compiled into it changes.

    Where numba keeps it, and its other options, are as numba has them.  With NUMBA_DISABLE_JIT the function stays as
    it is.  Not looked at: what a kernel closes over, and Python functions and classes that it names
    (`tests/contract/test_kernels.py` allows neither).
    """
    compiled = numba.njit(nogil=nogil, error_model=error_model, fastmath=fastmath, inline=inline)

    def decorated(function: Function) -> Function:
        kernel: Any = compiled(function)
        if cache and kernel is not function:
            kernel._cache = _KernelCache(kernel)  # noqa: SLF001 (`enable_caching` takes no cache of another kind)
        return kernel  # type: ignore[no-any-return]  # called as the function is

    return decorated


def stamp(kernel: Any) -> str:
    """Return a digest of all that compiling a kernel puts into its machine code, as it is now.

    That is, of the kernel and of each one that it reaches: its bytecode, its constants, its options, and the values of
    the globals that it names.  It is the same in each process of one Python version, wherever the files are.
    """
    digest, found = sha256(), [kernel]
    for each in found:  # grows as it goes
        for part in _parts(each):
            if not is_jitted(part):
                digest.update(part.encode() + b"\n")
            elif part not in found:
                found.append(part)
    return digest.hexdigest()


def _parts(kernel: Any) -> Iterator[Any]:
    """Return what one kernel is made of: texts, and the kernels that it names."""
    function = kernel.py_func
    yield _value((function.__module__, function.__qualname__, function.__code__, function.__defaults__))
    yield _value(kernel.targetoptions)
    yield from _meant(sorted(_names(function.__code__)), function.__globals__, set())


def _meant(names: list[str], variables: dict[str, Any], seen: set[str]) -> Iterator[Any]:
    """Return what names mean in a module, and in each module among them: `kernel.GAIN` is two names."""
    for name in names:
        value: Any = variables.get(name)
        if isinstance(value, types.ModuleType):
            if value.__name__ not in seen:
                seen.add(value.__name__)
                yield from _meant(names, vars(value), seen)
        elif name in variables:
            yield f"{name} {_value(value)}"
            if is_jitted(value):
                yield value


def _names(code: types.CodeType) -> set[str]:
    """Return the names of globals and attributes that a function has, comprehensions within included."""
    within = [each for each in code.co_consts if isinstance(each, types.CodeType)]
    return set(code.co_names).union(*(_names(each) for each in within))


def _value(value: Any) -> str:
    """Return a value as a text that tells it from any other one, the same in each process."""
    match value:
        case tuple() | list():
            return f"{type(value).__name__}({', '.join(_value(each) for each in value)})"
        case set() | frozenset():
            return f"set({sorted(_value(each) for each in value)})"
        case dict():
            return _value([(key, value[key]) for key in sorted(value)])
        case np.ndarray() | np.generic():
            array = np.asarray(value)
            return f"{array.dtype!r} {array.shape} {sha256(array.tobytes()).hexdigest()}"
        case types.CodeType():
            names = (value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars)
            shape = (value.co_argcount, value.co_flags, value.co_exceptiontable)
            return _value((value.co_code, value.co_consts, names, shape))
        case _ if callable(value):
            return f"{value.__module__}.{getattr(value, '__qualname__', value)}"
    return repr(value)


class _KernelCache(FunctionCache):  # type: ignore[misc]  # typed as Any
    """Numba's cache of one kernel, in files whose names have its stamp: what is old and what is new never mix."""

    def __init__(self, kernel: Any) -> None:
        super().__init__(kernel.py_func)
        self._kernel, self._name = kernel, self._impl.filename_base

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the machine code of a signature; None where there is none of what the kernel is made of now."""
        made_of = stamp(self._kernel)
        self._stamped = f"{self._name}.{made_of[:16]}"
        self._cache_file = IndexDataCacheFile(self.cache_path, self._stamped, made_of)
        return super().load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it, and remove what is kept of what the kernel was made of before."""
        super().save_overload(sig, data)
        for file in Path(self.cache_path).glob(f"{escape(self._name)}.*nb[ic]"):
            if not file.name.startswith(self._stamped):
                with suppress(OSError):  # another process was first, or reads it
                    file.unlink()

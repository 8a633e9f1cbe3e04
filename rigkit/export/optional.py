"""Packages that only an export needs."""

import importlib
from collections.abc import Iterable
from typing import Any

_NEEDED = {"uff": "pyuff", "segy": "segyio", "mcap": "mcap.writer", "parquet": "pyarrow.parquet"}
"""By format; the others need none."""


def refuse_missing(formats: Iterable[str]) -> None:
    """Refuse formats whose packages are not installed, before anything is written, by the ValueError of `optional`."""
    for name in formats:
        if name in _NEEDED:
            optional(_NEEDED[name])


def optional(package: str) -> Any:
    """Import a package that only an export needs.

    Raises
    ------
    ValueError : it is not installed; it says how to install it.
    """
    try:
        return importlib.import_module(package)
    except ImportError as fault:
        raise ValueError(
            f"this format needs {package}, which is not there ({fault}): pip install 'vibrostage[export]'"
        ) from None

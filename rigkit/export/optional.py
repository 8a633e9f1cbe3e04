"""Packages that only an export needs."""

import importlib
from typing import Any


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
            f"this format needs {package}, which is not there ({fault}): pip install vibrostage[export]"
        ) from None

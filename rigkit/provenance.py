"""Which software made a result, and when."""

import platform
import shutil
import subprocess
from collections.abc import Sequence
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_CHECKOUT = Path(__file__).parent.parent
_PATIENCE = 5.0
"""s."""


def now() -> str:
    """Return the time, UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@cache
def software(packages: Sequence[str] = ("numpy", "scipy", "numba", "pyfftw")) -> str:
    """Return the versions of this program, of `packages` (a tuple) and of Python; the commit where it runs from one."""
    own = f"vibrostage {version('vibrostage')}"
    if commit := _commit():
        own += f" ({commit})"
    theirs = [f"{name} {found}" for name in packages if (found := _version(name))]
    return ", ".join([own, *theirs, f"Python {platform.python_version()}"])


def _version(package: str) -> str:
    """Return the version of a package that may be missing, as pyfftw may; empty then."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _commit() -> str:
    """Return the checkout's commit, with "+" after it when files differ from it; nothing outside of a checkout."""
    if not (_CHECKOUT / ".git").exists() or shutil.which("git") is None:
        return ""
    command = ["git", "-C", str(_CHECKOUT), "describe", "--always", "--abbrev=12", "--dirty=+", "--exclude=*"]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=_PATIENCE).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        return ""

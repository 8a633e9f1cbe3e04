"""Memory of large arrays is given back to the machine as soon as they are freed."""

import ctypes
import sys

_M_MMAP_THRESHOLD = -3
"""Of glibc's malloc.h."""
LARGE = 2**22
"""Bytes."""


def give_back_large_arrays() -> None:
    """Keep arrays of 4 MB and more out of the heap: without this glibc takes them there, and holes stay behind.

    On another C library nothing is done.
    """
    if sys.platform == "linux" and hasattr(libc := ctypes.CDLL(None), "mallopt"):
        libc.mallopt(_M_MMAP_THRESHOLD, LARGE)

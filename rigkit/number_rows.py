"""Blocks of text that hold nothing but full rows of finite numbers, read at once."""

import warnings
from codecs import BOM_UTF8
from functools import cache
from importlib.util import find_spec

import numpy as np

_PLAIN = b"0123456789+-.eE \n"


def number_rows(block: bytes, between: str | None, width: int, decimal: str, columns: range) -> np.ndarray | None:
    r"""Return columns of a block, shape (rows, columns); None where it is not such a block, or cannot be told to be.

    Parameters
    ----------
    block : bytes
        Lines that end in \n.
    between : str or None
        What stands between two cells, one character; None for spaces.
    width : int
        Cells of a row.
    decimal : str
        "." or ",".
    columns : range
        Those that are wanted.

    Notes
    -----
    Arrow's parser, where pyarrow is installed, takes a third of the time of numpy's, and does not take all that is a
    number: "+1".  And it would skip a byte-order mark, which in the middle of a file is no part of a number.
    """
    data = None
    if between is not None and not block.startswith(BOM_UTF8) and _has_arrow():
        data = _by_arrow(block, between, width, decimal, columns)
    if data is None:
        data = _by_numpy(block, between, width, decimal, columns)
    return data if data is not None and len(data) == block.count(b"\n") and np.isfinite(data).all() else None


@cache
def _has_arrow() -> bool:
    return find_spec("pyarrow") is not None


def _by_arrow(block: bytes, between: str, width: int, decimal: str, columns: range) -> np.ndarray | None:
    import pyarrow  # a tenth of a second, for those alone who read tables
    from pyarrow import csv as arrow

    names = [str(column) for column in range(width)]
    wanted = [names[column] for column in columns]
    types = dict.fromkeys(names, pyarrow.float64())
    try:
        found = arrow.read_csv(
            pyarrow.BufferReader(block),
            arrow.ReadOptions(use_threads=False, column_names=names, block_size=len(block) + 1),
            arrow.ParseOptions(delimiter=between, quote_char=False),
            arrow.ConvertOptions(column_types=types, include_columns=wanted, decimal_point=decimal, null_values=[]),
            memory_pool=pyarrow.system_memory_pool(),
        )
    except pyarrow.ArrowInvalid:
        return None
    return np.stack([found.column(name).to_numpy() for name in wanted], axis=1)


def _by_numpy(block: bytes, between: str | None, width: int, decimal: str, columns: range) -> np.ndarray | None:
    if decimal == ",":
        if b"." in block:
            return None
        block = block.replace(b",", b".")
    if block.translate(None, _PLAIN + (between or " ").encode()):
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a block without numbers is told by a warning
            data = np.loadtxt(block.decode().split("\n"), delimiter=between, comments=None, ndmin=2)
    except (ValueError, Warning):
        return None
    return data[:, columns] if data.shape[1] == width else None

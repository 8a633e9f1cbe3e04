"""Blocks of text that hold nothing but full rows of finite numbers, read at once."""

import warnings
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
    number: "+1".
    """
    data = None
    if between is not None and _has_arrow():
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
    mark = (between or " ").encode()
    if decimal == ",":
        if b"." in block:
            return None
        block = block.replace(b",", b".")
    if block.translate(None, _PLAIN + mark):
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # so numpy < 2.3 says that it stopped
            data = _between_spaces(block, width) if between is None else _between_marks(block, mark, width)
    except (ValueError, Warning):
        return None
    return None if data is None else data[:, columns]


def _between_spaces(block: bytes, width: int) -> np.ndarray | None:
    data = np.loadtxt(block.decode().split("\n"), comments=None, ndmin=2)
    return data if data.shape[1] == width else None


def _between_marks(block: bytes, between: bytes, width: int) -> np.ndarray | None:
    codes = np.frombuffer(block, np.uint8)
    ends = codes[(codes == between[0]) | (codes == ord("\n"))]
    row = np.frombuffer(between * (width - 1) + b"\n", np.uint8)
    if len(ends) % width or not (ends.reshape(-1, width) == row).all():
        return None
    data: np.ndarray = np.fromstring(block[:-1].replace(between, b",").replace(b"\n", b",").decode(), sep=",")
    return data.reshape(-1, width) if len(data) == len(ends) else None

"""The variables of an HDF5 file, MATLAB's version 7.3 among them."""

from math import prod

import h5py
import numpy as np

from rigkit.array_variables import Contents, RefusedError, Variable

COMPRESSED = 1100
"""How many times as large as its file a dataset may be: deflate makes of a byte no more than 1032."""
LARGEST_CHUNK = 2**27
"""Bytes of a chunk, which the library reads whole."""
_TEXT = (b"char", b"logical", b"cell", b"struct", b"function_handle")
"""Classes of MATLAB that it keeps as numbers, or as references to them."""


def hdf5_contents(file: h5py.File) -> Contents:
    """Return what is in an open file.

    Parameters
    ----------
    file : h5py.File

    Raises
    ------
    RefusedError : a dataset that cannot be in the file, or is not read in blocks.
    """
    found = Contents(numbers=dict(file.attrs))

    def visit(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and not name.startswith("#"):
            _add(found, name, item)

    file.visititems(visit)
    return found


def _add(found: Contents, name: str, dataset: h5py.Dataset) -> None:
    kind = dataset.attrs.get("MATLAB_class")
    if dataset.dtype.kind not in "fiu" or kind in _TEXT or "MATLAB_empty" in dataset.attrs or dataset.ndim > 2:
        found.others.append(f"{name} ({dataset.dtype}{f', {kind.decode()}' if isinstance(kind, bytes) else ''})")
    elif dataset.size == 1:
        found.numbers[name] = dataset[()]
    else:
        found.variables.append(_variable(name, dataset, is_turned=kind is not None))


def _variable(name: str, dataset: h5py.Dataset, is_turned: bool) -> Variable:
    """Return a dataset as a variable; one of MATLAB has its axes turned."""
    shape, chunk = (tuple(each) if each else () for each in (dataset.shape, dataset.chunks))
    size = dataset.file.id.get_filesize()
    if dataset.nbytes > size * (COMPRESSED if chunk else 1):
        raise RefusedError(f"{name} has {dataset.nbytes} bytes, in a file of {size}")
    missing = _missing(dataset)
    if missing:
        raise RefusedError(f"{name} is not whole: {missing}")
    if prod(chunk) * dataset.dtype.itemsize > LARGEST_CHUNK:
        raise RefusedError(f"{name} has chunks of {chunk}, must be <= {LARGEST_CHUNK} bytes")
    axis = 0
    if is_turned and len(shape) == 2:
        shape, axis = shape[::-1], 1
    is_row = is_turned and len(shape) == 2 and shape[0] == 1  # a row of MATLAB's is a signal like a column
    frames, width = (shape[1], 1) if is_row else (shape[0], 1 if len(shape) == 1 else shape[1])
    axis = axis ^ is_row

    def read(start: int, stop: int) -> np.ndarray:
        part = dataset[start:stop] if axis == 0 else dataset[:, start:stop].T
        return np.asarray(part).reshape(stop - start, width)

    unit = str(dataset.attrs.get("unit", dataset.attrs.get("units", "1")))
    grain = chunk[axis] if chunk else 1
    return Variable(name, frames, width, read, unit, dataset.attrs.get("rate"), max(int(grain), 1))


def _missing(dataset: h5py.Dataset) -> str:
    """Say what of a dataset is not in the file, whose place the library fills by zeros; empty for nothing."""
    if dataset.external or dataset.is_virtual:
        return "its samples are in other files"
    if dataset.chunks is None:
        stored = dataset.id.get_storage_size()
        return "" if stored == dataset.nbytes else f"{stored} bytes are stored, must be {dataset.nbytes}"
    stored = dataset.id.get_num_chunks()
    wanted = prod(-(-length // chunk) for length, chunk in zip(dataset.shape, dataset.chunks, strict=True))
    return "" if stored == wanted else f"{stored} chunks are stored, must be {wanted}"

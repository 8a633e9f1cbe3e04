"""HDF5 files that say when they were changed or damaged after they were written, before the HDF5 library reads them.

The library crashes on some damaged files.  So the SHA-256 of all that it is to read stands in the block of 512 bytes
that HDF5 leaves to its user at the beginning of a file.
"""

import hashlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

from rigkit.atomic import replacing

_USER_BLOCK = 512
UNREADABLE = (OSError, KeyError, RuntimeError, TypeError, ValueError, AttributeError)
"""What h5py and numpy raise of a file without what it should have."""
_MARK = b"vibrostage sha256 "
_HDF5 = b"\x89HDF\r\n\x1a\n"


@contextmanager
def sealed(path: Path) -> Iterator[h5py.File]:
    """Give an HDF5 file to be filled; it takes the place of `path` when the block ends, whole and sealed."""
    content = io.BytesIO()  # and not the disk: of one that is full the library speaks in riddles, and leaves files open
    with h5py.File(content, "w", userblock_size=_USER_BLOCK) as file:
        yield file
    with replacing(path, content.getbuffer().nbytes) as partial:
        partial.write_bytes(content.getbuffer())
        seal(partial)


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Open a file for reading.

    Raises
    ------
    ValueError : it is not as it was sealed.
    OSError : it was never, by an older program or another, and is no HDF5.
    """
    _refuse_changed(path)
    with h5py.File(path, "r") as file:
        yield file


def seal(path: Path) -> None:
    """Write the checksum of a file that was made by `sealed`, and may have been changed since."""
    with path.open("rb+") as file:
        file.seek(_USER_BLOCK)
        checksum = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0)
        file.write(_MARK + checksum.encode())


def whole(dataset: h5py.Dataset) -> np.ndarray:
    """Return all of a dataset, any shape and unit; ValueError where it says that it is larger than its file."""
    size = dataset.file.id.get_filesize()
    if dataset.chunks is None and dataset.nbytes > size:
        raise ValueError(f"{dataset.name} has {dataset.nbytes} bytes, in a file of {size}")
    return np.asarray(dataset)


def _refuse_changed(path: Path) -> None:
    with path.open("rb") as file:
        head = file.read(_USER_BLOCK)
        if head.startswith(_HDF5):
            return
        if not head.startswith(_MARK):
            raise ValueError("is no HDF5 file, or a damaged one")
        said = head.removeprefix(_MARK)[:64].decode(errors="replace")
        if said != hashlib.file_digest(file, "sha256").hexdigest():
            raise ValueError("was changed or damaged after it was written: its checksum is another")

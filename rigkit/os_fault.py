"""What an error of the system says to a person."""

import os
from pathlib import Path


def told(fault: OSError) -> str:
    """Say which file or device fails, and at what; where a folder was looked for within a file, which file that is."""
    if not fault.filename:
        return fault.strerror or str(fault)
    path = os.fsdecode(fault.filename)
    if isinstance(fault, NotADirectoryError):
        for above in reversed(Path(path).parents):
            if above.exists() and not above.is_dir():
                return f"{above}: is a file, must be a folder"
    return f"{path}: {fault.strerror}"

"""Where the raw recordings of a calibration go: a folder beside the model file."""

from pathlib import Path


def raw_folder(out: Path) -> Path:
    """Return the folder of a model file's recordings, `out` with the suffix .raw.

    Parameters
    ----------
    out : Path
        Of the model.

    Raises
    ------
    ValueError : the model would not be an .h5 file, there is no folder for it, or it would take the place of a file
        whose recordings are not there.
    """
    folder = out.with_suffix(".raw")
    if not out.parent.is_dir():
        raise ValueError(f"{out}: there is no folder {out.parent}")
    if out.suffix != ".h5":
        raise ValueError(f"{out}: the suffix is {out.suffix!r}, must be '.h5'")
    if out.exists() and not (out.is_file() and folder.is_dir()):
        raise ValueError(f"{out}: is there already, without its recordings in {folder}/; choose another name")
    return folder

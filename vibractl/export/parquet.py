"""A run as Parquet: a file for the reference, one for each shot, one for the responses."""

from pathlib import Path

from rigkit import atomic
from rigkit.export.parquet_file import write_recording, write_table
from vibractl.export.content import Content
from vibractl.export.csv import FAR_FIELD, RESPONSES, response_columns, response_words


def write_parquet(folder: Path, content: Content) -> list[Path]:
    """Write `responses.parquet` and `far-field.parquet` if known, `reference.parquet`, `shot-0000.parquet` and so on.

    Parameters
    ----------
    folder : Path
        There already.
    content : Content

    Returns
    -------
    list of Path
    """
    written = []
    matrices = {} if content.matrix is None else {"responses": (content.matrix, RESPONSES)}
    if content.far is not None:
        matrices["far-field"] = (content.far.late, FAR_FIELD)
    for name, (matrix, kind) in matrices.items():
        written.append(folder / f"{name}.parquet")
        with atomic.replacing(written[-1]) as temporary:
            write_table(temporary, response_columns(matrix, kind), response_words(matrix, content.about, kind))
    for name, record in content.recordings():
        written.append(folder / f"{name}.parquet")
        with atomic.replacing(written[-1]) as temporary:
            write_recording(temporary, record)
    return written

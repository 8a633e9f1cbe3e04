"""A run as Universal File Format, dataset 58: responses with coherence, spectra and time signals, through pyuff."""

import tempfile
import warnings
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from rigkit.export.optional import optional
from vibractl.export.content import Content
from vibractl.far_field import FarField
from vibractl.transfer_matrix import TransferMatrix

TIME, AUTO_SPECTRUM, RESPONSE, COHERENCE = 1, 2, 4, 6
"""Function types of record 6."""
AXIS_TIME, AXIS_FREQUENCY, ACCELERATION, PRESSURE, UNKNOWN = 17, 18, 12, 15, 0
"""Specific data types of records 8 to 10; there is none for volts."""
ALONG_AXIS, SCALAR = 1, 0
"""Directions: +X is an accelerometer's own axis; a coil's voltage has none."""
COLUMNS = 80
NAME_COLUMNS = 10

_QUANTITIES = {"m/s^2": (ACCELERATION, ALONG_AXIS), "Pa": (PRESSURE, SCALAR)}


def write_uff(path: Path, content: Content) -> None:
    """Write a run as dataset 58, every function with its units and degrees of freedom.

    Responses, coherences and spectra are text, double precision; time signals are binary (58b), double precision.

    Parameters
    ----------
    path : Path
        Written in place.
    content : Content

    Raises
    ------
    ValueError : pyuff is not installed.
    """
    pyuff = optional("pyuff")
    with (
        path.open("wb") as file,
        tempfile.TemporaryDirectory() as folder,
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves it to Python to close what it reopens
        for each in _functions(content):
            file.write(_as_written(pyuff, each, Path(folder) / "set.uff"))


def _as_written(pyuff: Any, function: dict[str, Any], scratch: Path) -> bytes:
    """Return one data set as pyuff writes it, into a file of its own: it scans its whole file after every set."""
    scratch.unlink(missing_ok=True)
    pyuff.UFF(str(scratch)).write_sets(function, mode="add")  # "overwrite" drops the header of a binary set
    return scratch.read_bytes()


def _functions(content: Content) -> Iterator[dict[str, Any]]:
    matrix = content.matrix
    about = f"rig {content.config.rig.name}, run {content.path.resolve().name}"
    created = _uff_date(None if matrix is None else matrix.provenance.get("date"))
    if matrix is not None:
        yield from _near_field(matrix, about, created)
    if content.far is not None:
        yield from _far_field(content.far, about, created)
    units = ["m/s^2"] * len(content.sides)
    yield from _signals(content, "reference", content.reference_names, content.reference, units, about)
    for number in content.files:
        record = content.shot(number)
        yield from _signals(content, f"shot {number}", record.names, record.data, record.units, about)


def _near_field(matrix: TransferMatrix, about: str, created: str) -> Iterator[dict[str, Any]]:
    """Return what accelerometers hear of coils."""
    for output in range(matrix.outputs):
        for coil in range(matrix.inputs):
            ends = _end("response", output + 1, ALONG_AXIS, "rsp") | _end("drive", coil + 1, SCALAR, "ref")
            element = {**ends, "id2": about, "id3": created, "abscissa_spacing": 0, "x": matrix.frequency}
            yield _function(
                RESPONSE,
                f"Frequency response of response_{output + 1} to drive_{coil + 1}",
                matrix.response[:, output, coil],
                "m/s^2",
                {**element, "orddenom_axis_lab": "drive", "orddenom_axis_units_lab": "V"},
            )
            yield _function(
                COHERENCE,
                f"Coherence of response_{output + 1} with drive_{coil + 1}",
                matrix.coherence[:, output, coil],
                "1",
                {**element, "id4": "part of the response's power at the bin that the drive explains"},
            )


def _far_field(far: FarField, about: str, created: str) -> Iterator[dict[str, Any]]:
    """Return what hydrophones hear of accelerometers, with the delay in the phase."""
    matrix = far.late
    for hydrophone, sensor in np.ndindex(matrix.outputs, matrix.inputs):
        ends = _end("far_field", hydrophone + 1, SCALAR, "rsp") | _end("response", sensor + 1, ALONG_AXIS, "ref")
        names = f"far_field_{hydrophone + 1}", f"response_{sensor + 1}"
        element = {**ends, "id2": about, "id3": created, "abscissa_spacing": 0, "x": matrix.frequency}
        yield _function(
            RESPONSE,
            f"Frequency response of {names[0]} to {names[1]}",
            matrix.response[:, hydrophone, sensor],
            "Pa",
            {
                **element,
                "orddenom_spec_data_type": ACCELERATION,
                "orddenom_axis_lab": "response",
                "orddenom_axis_units_lab": "m/s^2",
            },
        )
        said = {**element, "id4": "response squared over itself and its variance"}
        coherence = matrix.coherence[:, hydrophone, sensor]
        yield _function(COHERENCE, f"Coherence of {names[0]} with {names[1]}", coherence, "1", said)


def _signals(
    content: Content, what: str, names: Sequence[str], data: np.ndarray, units: Sequence[str], about: str
) -> Iterator[dict[str, Any]]:
    """Return the time signal of each channel, and the spectrum of what is heard while the reference lasts."""
    rate = content.rate
    exact = f"{rate:.10g} samples/s exactly; the reference begins at sample {content.lead}"
    axis = {"id2": about, "id5": exact, "abscissa_spacing": 1, "binary": 1, "x": np.arange(len(data)) / rate}
    for name, unit, signal in zip(names, units, data.T, strict=True):
        kind, _, place = name.rpartition("_")
        direction = _QUANTITIES.get(unit, (UNKNOWN, SCALAR))[1]
        end = _end(kind, int(place) if place.isdecimal() else 0, direction, "rsp") | _end("none", 0, SCALAR, "ref")
        yield _function(TIME, f"Time signal of {name}, {what}", signal.astype(float), unit, {**end, **axis})
        if kind != "drive":
            heard = signal[content.lead : content.lead + content.frames].astype(float)
            frequency, square = auto_spectrum(heard, rate, content.config.learning.band[1])
            yield _function(
                AUTO_SPECTRUM,
                f"Auto spectrum of {name}, {what}",
                square,
                f"({unit})^2",
                {**end, **axis, "binary": 0, "x": frequency, "id4": "mean square per bin while the reference lasts"},
            )


def auto_spectrum(signal: np.ndarray, rate: float, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Divide the mean square of a signal among the lines of its own length, without a window.

    Parameters
    ----------
    signal : array, shape (frames,), any unit
    rate : float, samples/s
    highest : float, Hz, the last line wanted

    Returns
    -------
    frequency : array, shape (lines,), Hz, from 0 on
    square : array, shape (lines,), the signal's unit squared
        A sine of amplitude A on a line gives A^2 / 2 there.
    """
    frequency = np.fft.rfftfreq(len(signal), 1 / rate)
    square = 2 * np.abs(np.fft.rfft(signal) / len(signal)) ** 2
    square[0] /= 2
    if len(signal) % 2 == 0:
        square[-1] /= 2
    kept = frequency <= highest
    return frequency[kept], square[kept]


def _function(kind: int, title: str, data: np.ndarray, unit: str, more: dict[str, Any]) -> dict[str, Any]:
    is_time = kind == TIME
    fields = {
        "type": 58,
        "func_type": kind,
        "id1": title,
        "id5": "NONE",
        "ver_num": 1,
        "load_case_id": 0,
        "data": data,
        "abscissa_spec_data_type": AXIS_TIME if is_time else AXIS_FREQUENCY,
        "abscissa_axis_lab": "time" if is_time else "frequency",
        "abscissa_axis_units_lab": "s" if is_time else "Hz",
        "ordinate_spec_data_type": _QUANTITIES.get(unit, (UNKNOWN, SCALAR))[0],
        "ordinate_axis_lab": title.split(" of ")[0],
        "ordinate_axis_units_lab": unit,
        "orddenom_spec_data_type": UNKNOWN,
        "z_axis_spec_data_type": UNKNOWN,
        **more,
    }
    return fields | {name: _line(fields[name]) for name in fields if name.startswith("id")}


def _end(kind: str, node: int, direction: int, side: str) -> dict[str, Any]:
    """Name one end of a function by its node, which is the number of the coil or accelerometer."""
    return {f"{side}_ent_name": kind.upper()[:NAME_COLUMNS], f"{side}_node": node, f"{side}_dir": direction}


def _line(text: str) -> str:
    """Make an ID line: ASCII, one record long."""
    return text.encode("ascii", "replace").decode()[:COLUMNS] or "NONE"


def _uff_date(date: str | None) -> str:
    """Write a date as ID line 3 wants it, DD-MMM-YY HH:MM:SS, from ISO 8601."""
    return datetime.fromisoformat(date).strftime("%d-%b-%y %H:%M:%S") if date else "NONE"

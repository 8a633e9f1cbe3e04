"""Files as other programs write them: three channels at 1 kHz, in every format that is read."""

import struct
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import soundfile

from ctlblocks import recording
from ctlblocks.recording import Recording

RATE = 1_000.0
FRAMES = 400
DATA = np.round(np.random.default_rng(1).normal(size=(FRAMES, 3)) / 10 * 2**15) / 2**15
"""Of 16 bits: the same in every format."""
TIME = np.arange(FRAMES) / RATE


def wav(kind: str, subtype: str) -> Callable[[Path, np.ndarray], None]:
    """Return what writes a sound."""
    return lambda path, data: soundfile.write(path, data, int(RATE), subtype, format=kind)


def own(path: Path, data: np.ndarray) -> None:
    """Write what this program writes."""
    recording.write(path, Recording(("a", "b", "c"), ("V", "V", "m"), RATE, data))


def table(
    head: str, between: str = ",", end: str = "\n", decimal: str = ".", first: str = ""
) -> Callable[[Path, np.ndarray], None]:
    """Return what writes a table with a column of time."""

    def write(path: Path, data: np.ndarray) -> None:
        rows = np.column_stack([np.arange(len(data)) / RATE, data])
        lines = [between.join(f"{number:.17g}".replace(".", decimal) for number in row) for row in rows]
        path.write_bytes((first + end.join([*filter(None, [head]), *lines, ""])).encode())

    return write


def labview(columns: str, decimal: str) -> Callable[[Path, np.ndarray], None]:
    """Return what writes a LabVIEW measurement file."""

    def write(path: Path, data: np.ndarray) -> None:
        head = (
            "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
            f"Decimal_Separator\t{decimal}\nMulti_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tsomebody\nDate\t2024/05/27\n"
            "Time\t13:26:10.3\n***End_of_Header***\t\n\t\nChannels\t3\t\t\t\nSamples\t100\t100\t100\t\n"
            "Date\t2024/05/27\t2024/05/27\t2024/05/27\t\nTime\t13:26:10\t13:26:10\t13:26:10\t\n"
            "Y_Unit_Label\tVolts\tVolts\tVolts\t\nX_Dimension\tTime\tTime\tTime\t\n"
            "X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\n"
            "Delta_X\t0.001000\t0.001000\t0.001000\t\n***End_of_Header***\t\t\t\t\n"
        ).replace("0.00", f"0{decimal}00")
        lines = ["X_Value\tUntitled\tUntitled 1\tUntitled 2\tComment"]
        for number, row in enumerate(data):
            time = f"{number / RATE:.6f}" if columns == "One" else ""
            cells = "\t".join([time, *(f"{value:.17g}" for value in row)]).replace(".", decimal)
            lines.append(cells + ("\tbegun by hand" if number == 0 else "\t" if number % 2 else ""))
        path.write_bytes((head + "\n".join(lines) + "\n").replace("\n", "\r\n").encode())

    return write


def hdf5(path: Path, data: np.ndarray) -> None:
    """Write datasets beside each other, compressed, with a rate as an attribute."""
    with h5py.File(path, "w") as file:
        file.attrs["rate"] = RATE
        file["x/first"] = data[:, 0]
        file["x/first"].attrs["unit"] = "V"
        file.create_dataset("y", data=data[:, 1:], chunks=(50, 1), compression="gzip")


def hdf5_timed(path: Path, data: np.ndarray) -> None:
    """Write datasets with time beside them."""
    with h5py.File(path, "w") as file:
        file["u"], file["y"] = data[:, 0], data[:, 1:]
        file["time"] = 1e3 * np.arange(len(data)) / RATE
        file["time"].attrs["units"] = "ms"


def mat(version: str, content: Callable[[np.ndarray], dict[str, object]]) -> Callable[[Path, np.ndarray], None]:
    """Return what writes a MAT file of version 4 or 5, compressed or not."""

    def write(path: Path, data: np.ndarray) -> None:
        scipy.io.savemat(path, content(data), format=version[0], do_compression=version.endswith("z"))

    return write


def vectors(data: np.ndarray) -> dict[str, object]:
    """Return rows and columns, a rate, and things that are none."""
    return {"u": data[:, 0], "y": data[:, 1:], "Fs": RATE, "note": "a rig", "gain": 2.0}


def timed_matrix(data: np.ndarray) -> dict[str, object]:
    """Return one matrix and a row of time."""
    return {"y": data, "t": np.arange(len(data))[None, :] / RATE}


def mat73(path: Path, data: np.ndarray) -> None:
    """Write HDF5 as MATLAB does: a block for its user, axes turned, classes as attributes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in {"u": data[:, :1], "y": data[:, 1:], "Ts": np.array([[1 / RATE]])}.items():
            file[name] = np.asarray(value).T
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["note"] = np.frombuffer("a rig".encode("utf-16-le"), np.uint16)[:, None]
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as raw:
        raw.write(
            b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon May 27 13:26:10 2024 HDF5 schema 1.00 .".ljust(
                124
            )
        )
        raw.write(struct.pack("<H2s", 0x0200, b"IM"))


Writer = Callable[[Path, np.ndarray], None]
UNNAMED = ("channel_1", "channel_2", "channel_3"), ("1", "1", "1")
ABC = ("a", "b", "c")
FORMATS: dict[str, tuple[Writer, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "16.wav": (wav("WAV", "PCM_16"), UNNAMED),
    "24.wav": (wav("WAV", "PCM_24"), UNNAMED),
    "32.WAV": (wav("WAVEX", "PCM_32"), UNNAMED),
    "float.wav": (wav("WAVEX", "FLOAT"), UNNAMED),
    "double.wav": (wav("WAV", "DOUBLE"), UNNAMED),
    "rf64.wav": (wav("RF64", "PCM_24"), UNNAMED),
    "16.flac": (wav("FLAC", "PCM_16"), UNNAMED),
    "24.flac": (wav("FLAC", "PCM_24"), UNNAMED),
    "own.wav": (own, (ABC, ("V", "V", "m"))),
    "own.csv": (own, (ABC, ("V", "V", "m"))),
    "brackets.csv": (table("t [s],a [mV],b[m/s^2],c"), (ABC, ("mV", "m/s^2", "1"))),
    "parentheses.tsv": (table("Time (s)\ta (V)\tb (m/s^2)\tc (N m)", "\t"), (ABC, ("V", "m/s^2", "N m"))),
    "units row.txt": (table("time\ta\tb\tc\ns\tV\t(m/s^2)\t-", "\t"), (ABC, ("V", "m/s^2", "-"))),
    "quoted.csv": (table('"t","a [V]","b","c"'), (ABC, ("V", "1", "1"))),
    "mark.csv": (table("t,a,b,c", first="\ufeff"), (ABC, ("1", "1", "1"))),
    "comma.csv": (table("t;a;b;c", ";", "\r\n", ","), (ABC, ("1", "1", "1"))),
    "comma.txt": (table("t a b c", " ", decimal=","), (ABC, ("1", "1", "1"))),
    "mac.csv": (table("t,a,b,c", end="\r"), (ABC, ("1", "1", "1"))),
    "remarks.csv": (table("# by a logger\n% of ours\n\nt_s,a,b,c"), (ABC, ("1", "1", "1"))),
    "one.lvm": (labview("One", "."), (("Untitled", "Untitled 1", "Untitled 2"), ("V", "V", "V"))),
    "no.lvm": (labview("No", ","), (("Untitled", "Untitled 1", "Untitled 2"), ("V", "V", "V"))),
    "a.h5": (hdf5, (("x/first", "y_1", "y_2"), ("V", "1", "1"))),
    "timed.hdf5": (hdf5_timed, (("u", "y_1", "y_2"), ("1", "1", "1"))),
    "4.mat": (mat("4", timed_matrix), (("y_1", "y_2", "y_3"), ("1", "1", "1"))),
    "5.mat": (mat("5", vectors), (("u", "y_1", "y_2"), ("1", "1", "1"))),
    "7.mat": (mat("5z", timed_matrix), (("y_1", "y_2", "y_3"), ("1", "1", "1"))),
    "73.mat": (mat73, (("u", "y_1", "y_2"), ("1", "1", "1"))),
}
"""What writes a file of this name, and the names and units of its channels."""

"""A run as SEG-Y revision 1: a trace for each channel and shot at a whole number of microseconds, through segyio."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import firwin, resample_poly

from rigkit.export.optional import optional
from vibractl.export.content import Content
from vibractl.reference import sweep_of
from vibractl.spectrum import DECIMATOR_BETA, DECIMATOR_CORNER

INTERVALS_US = (2000, 1000, 500, 250, 125, 50)
"""Sample intervals that traces are written at; SEG-Y holds whole microseconds, and 44.1 kHz is none."""
KEPT = 0.8
"""Of half the new rate: up to here the resampling filter is flat."""
REACH = 34
"""Samples at the lower rate to each side of the filter: its transition, 100 dB, ends below half the new rate."""
IEEE_FLOAT, AS_RECORDED, METRES, NOT_CORRELATED = 5, 1, 1, 1
LINEAR, COSINE_SQUARED = 1, 2
LARGEST_COUNT = 32_767
"""Of what has two bytes: samples of a trace, milliseconds of a sweep."""
SWEEP, VIBRATOR_REFERENCE, LIVE, PRESSURE = 6, 21, 1, 11
"""Trace identification codes of bytes 29-30 (SEG-Y rev 1, 2002): sweep, vibrator reference, seismic, pressure."""
MEASURES, OTHER_UNIT = {"Pa": 1, "V": 2, "m/s^2": 7}, -1
"""Units of a trace's values, bytes 203-204."""
_CODES = {"V": SWEEP, "m/s^2": LIVE, "Pa": PRESSURE}
_LINES, _COLUMNS = 40, 76
_SWEEP_OF_FILE = (
    "SweepFrequencyStart", "SweepFrequencyEnd", "SweepLength", "Sweep", "SweepTaperStart", "SweepTaperEnd", "Taper"
)  # fmt: skip
_SWEEP_OF_TRACE = (
    "SweepFrequencyStart", "SweepFrequencyEnd", "SweepLength", "SweepType", "SweepTraceTaperLengthStart",
    "SweepTraceTaperLengthEnd", "TaperType",
)  # fmt: skip


def write_segy(path: Path, content: Content) -> None:
    """Write reference, drives and measured signals of every shot, resampled to one of `INTERVALS_US`.

    Parameters
    ----------
    path : Path
        Written in place.
    content : Content

    Raises
    ------
    ValueError : segyio is not installed, or the learned band fits none of the intervals.
    """
    segyio = optional("segyio")
    rate, sides = content.config.audio.rate, len(content.sides)
    interval = interval_us(content.config.learning.band[1])
    reference = resampled(content.reference, rate, interval)
    if len(reference) > LARGEST_COUNT:
        raise ValueError(f"a shot has {len(reference)} samples at {interval} us, must be <= {LARGEST_COUNT} for SEG-Y")
    record = content.shot(min(content.files))
    heard = sum(unit != "V" for unit in record.units)
    names, units = (*content.reference_names, *record.names), (*["m/s^2"] * sides, *record.units)
    spec = segyio.spec()
    spec.format, spec.tracecount = IEEE_FLOAT, len(content.files) * len(names)
    spec.samples = np.arange(len(reference)) * interval / 1000
    common = _timing(segyio, content, interval, len(reference))
    with segyio.create(str(path), spec) as file:
        file.text[0] = segyio.tools.create_text_header(_words(content, names, units, interval))
        file.bin.update(_header(segyio, content, interval, len(reference), len(names), heard))
        place = 0
        for number in content.files:
            data = resampled(content.shot(number).select(record.names).data, rate, interval)
            for channel, signal in enumerate(np.hstack([reference, data]).T):
                file.header[place] = common | _place(segyio, place, number, channel, units[channel], channel < sides)
                file.trace[place] = np.ascontiguousarray(signal, np.float32)
                place += 1


def interval_us(highest: float) -> int:
    """Return the longest sample interval, microseconds, that keeps all up to `highest`, Hz, as it is.

    Raises
    ------
    ValueError : the shortest interval is too long.

    Examples
    --------
    >>> interval_us(650.0)
    500
    """
    for interval in INTERVALS_US:
        if highest <= KEPT * 0.5e6 / interval:
            return interval
    most = KEPT * 0.5e6 / INTERVALS_US[-1]
    raise ValueError(f"learning.band goes to {highest:g} Hz, must be <= {most:g} Hz for SEG-Y")


def resampled(signal: np.ndarray, rate: int, interval: int) -> np.ndarray:
    """Change the rate of a signal through one linear-phase low-pass of 100 dB, its delay compensated.

    Sample n of the result lies at exactly n intervals after the signal's first.

    Parameters
    ----------
    signal : array, shape (samples, width), any unit, silent outside
    rate : int, samples/s
    interval : int, microseconds

    Returns
    -------
    array, shape (new samples, width), the same unit
    """
    common = math.gcd(rate * interval, 1_000_000)
    up, down = 1_000_000 // common, rate * interval // common
    widest = max(up, down)
    taps = firwin(2 * REACH * widest + 1, DECIMATOR_CORNER / widest, window=("kaiser", DECIMATOR_BETA))
    result: np.ndarray = resample_poly(np.asarray(signal, float), up, down, axis=0, window=taps)
    return result


def _header(segyio: Any, content: Content, interval: int, samples: int, traces: int, responses: int) -> dict[int, int]:
    """Return the binary header: what holds for the whole file."""
    field = segyio.BinField
    return {
        field.Traces: responses,
        field.AuxTraces: traces - responses,
        field.Interval: interval,
        field.IntervalOriginal: round(1e6 / content.rate),
        field.Samples: samples,
        field.SamplesOriginal: 0,  # more than two bytes hold
        field.Format: IEEE_FLOAT,
        field.SortingCode: AS_RECORDED,
        field.MeasurementSystem: METRES,
        field.CorrelatedTraces: NOT_CORRELATED,
        field.SEGYRevision: 1,
        field.TraceFlag: 1,
    } | _sweep(content, [getattr(field, name) for name in _SWEEP_OF_FILE])


def _timing(segyio: Any, content: Content, interval: int, samples: int) -> dict[int, int]:
    """Return what the headers of all traces have in common."""
    field = segyio.TraceField
    return {
        field.TRACE_SAMPLE_COUNT: samples,
        field.TRACE_SAMPLE_INTERVAL: interval,
        field.DelayRecordingTime: -round(1000 * content.lead / content.rate),
        field.Correlated: NOT_CORRELATED,
        field.AliasFilterFrequency: round(DECIMATOR_CORNER * 0.5e6 / interval),
        field.DataUse: 2,  # test
    } | _sweep(content, [getattr(field, name) for name in _SWEEP_OF_TRACE])


def _place(segyio: Any, trace: int, shot: int, channel: int, unit: str, is_reference: bool) -> dict[int, int]:
    """Return what the header of one trace says beside that; all numbers from 1."""
    field = segyio.TraceField
    return {
        field.TRACE_SEQUENCE_LINE: trace + 1,
        field.TRACE_SEQUENCE_FILE: trace + 1,
        field.FieldRecord: shot + 1,
        field.EnergySourcePoint: shot + 1,
        field.TraceNumber: channel + 1,
        field.TraceIdentificationCode: VIBRATOR_REFERENCE if is_reference else _CODES.get(unit, LIVE),
        field.TraceValueMeasurementUnit: MEASURES.get(unit, OTHER_UNIT),
    }


def _sweep(content: Content, fields: list[int]) -> dict[int, int]:
    """Return first and last frequency, length, type and tapers of a sweep; nothing where it is none."""
    ends, length = sweep_of(content.text), round(1000 * content.frames / content.rate)
    if ends is None or length > LARGEST_COUNT:
        return {}
    taper = round(content.config.reference.taper * length)
    values = (*map(round, ends), length, LINEAR, taper, taper, COSINE_SQUARED)
    return dict(zip(fields, values, strict=True))


def _words(content: Content, names: tuple[str, ...], units: tuple[str, ...], interval: int) -> dict[int, str]:
    """Return the lines of the textual header, which says what is what."""
    rate = content.rate
    lines = [
        f"RIG {content.config.rig.name}, RUN {content.path.resolve().name}",
        f"REFERENCE {content.text}, BEGINS {1000 * content.lead / rate:.4f} MS AFTER THE FIRST SAMPLE",
        "MARINE VIBRATOR LEARNING ITS SWEEP: A FIELD RECORD FOR EACH SHOT",
        f"FIELD RECORD (BYTES 9-12) = SHOT + 1; SHOTS HERE: {len(content.files)}, "
        f"FROM {min(content.files)} TO {max(content.files)}",
        f"RECORDED AT {rate:.10g} SAMPLES/S, WHICH IS NO WHOLE NUMBER OF MICROSECONDS;"
        if 1_000_000 % rate
        else f"RECORDED AT {rate:.10g} SAMPLES/S;",
        f"RESAMPLED TO EXACTLY {interval} US, LINEAR PHASE, 100 DB, DELAY COMPENSATED;",
        f"UNCHANGED UP TO {KEPT * 0.5e6 / interval:g} HZ, NOTHING IS LEFT ABOVE {0.5e6 / interval:g} HZ",
        "SAMPLES ARE IEEE FLOAT IN SI UNITS, NOT SCALED; NOT CORRELATED",
        "TRACE NUMBER IN THE RECORD (BYTES 13-16), CHANNEL, UNIT:",
        *(f"  {n:3d}  {name}  {unit}" for n, (name, unit) in enumerate(zip(names, units, strict=True), 1)),
    ]
    room = _LINES - 3
    if len(lines) > room:
        lines[room - 1 :] = [f"  AND {len(lines) - room + 1} MORE"]
    lines += [""] * (room - len(lines))
    lines += [content.about["exported_by"], "SEG Y REV1", "END TEXTUAL HEADER"]
    return {number: text.encode("ascii", "replace").decode()[:_COLUMNS] for number, text in enumerate(lines, 1)}

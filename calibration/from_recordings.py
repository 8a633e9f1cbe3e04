"""The transfer matrix of a vibrator from recordings of anybody's: what each tells, and where nothing does."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from calibration.collinearity import TOGETHER
from calibration.multisine_estimate import FLOOR
from calibration.recorded_blocks import Wanted
from calibration.recorded_clock import Stack, turned
from calibration.recorded_pair import LATEST, FromRecordingsError, Prepared, prepared
from calibration.recorded_response import around
from calibration.recorded_signals import SHORTEST, Recorded
from calibration.recorded_sum import Lines, Sum, narrow_or_wide
from calibration.stretches import stretches
from calibration.sweep_estimate import decimation
from vibractl.config import RigConfig
from vibractl.transfer_matrix import GAPS, TransferMatrix

SPACING = 0.5
"""Hz, of the lines of the model."""
BEYOND = 10.0
"""Hz past the band that windows may reach."""
UNKNOWN = 0.5
"""Of |G|, Frobenius, averaged over `WIDTH`: lines whose standard deviation is larger have no value."""
WIDTH = 4
"""Lines to each side."""
EXCITED = 1e-4
"""Of the strongest drive's strongest line: weaker ones count as not driven at all ..."""
WEAK = 3e-2
"""... and these are to blame where nothing certain is heard."""
FOLLOWS = 0.3
"""Coherence below which a response has nothing to do with the drives."""
NOISE, UNRELATED = "too much noise", "the responses do not follow the drives"
EDGE, TOLD = 20, 3
"""Lines; and bands that are named in an error."""
LATER = 1.0
"""Samples by which the responses of two recordings may differ in how late they are: 5 degrees at 650 Hz."""


@dataclass(frozen=True)
class Gap:
    """A band without values.

    Parameters
    ----------
    low, high : float, Hz
    reason : str
    """

    low: float
    high: float
    reason: str

    @property
    def text(self) -> str:
        """It in words."""
        return f"{self.low:g} to {self.high:g} Hz: {self.reason}"


@dataclass(frozen=True)
class Found:
    """What recordings give.

    Parameters
    ----------
    matrix : TransferMatrix
        On the lines that have values for every element.
    wanted : array, shape (lines asked for,), Hz
    gaps : tuple of Gap
    records : tuple of Prepared
    late : float, s
        By which responses begin after drives: it is in the matrix, or taken out of it.
    is_late : bool
        Whether it is in the matrix.
    """

    matrix: TransferMatrix
    wanted: np.ndarray
    gaps: tuple[Gap, ...]
    records: tuple[Prepared, ...]
    late: float
    is_late: bool

    @property
    def seconds(self) -> float:
        """Recorded in all, s."""
        return sum(each.seconds for each in self.records)


def matrix_from(
    records: Sequence[Recorded],
    config: RigConfig,
    about: Mapping[str, str],
    correct_clock: bool = False,
    done: Callable[[float], object] = float,
) -> Found:
    """Estimate the transfer matrix.

    Parameters
    ----------
    records : sequence of Recorded
        At the rig's rate.
    config : RigConfig
        Its `characterisation.band` is wanted.
    about : mapping of str to str
        The model's words.
    correct_clock : bool
        Whether a difference of clocks, and of beginnings, is taken out; else one that is told is refused.
    done : callable(float)
        Told of the seconds read of all recordings.

    Raises
    ------
    FromRecordingsError : a record is too short, clocks differ, or no line has a value.
    """
    wanted, rate = _wanted(config, correct_clock), config.audio.rate
    ready: list[Prepared] = []
    sums: list[Sum] = []
    for record in records:
        known = ready[0].late if ready and not correct_clock else None
        each, own = prepared(record, wanted, known, _after(sum(each.seconds for each in ready), done))
        if sums:
            turn = _turn_beside(sums, own, (ready[0], each), wanted, rate)
            sums = [total.added(one, turn) for total, one in zip(sums, own, strict=True)]
        else:
            sums = own
        ready.append(each)
    lines = narrow_or_wide([each.solved(len(config.audio.drive_channels)) for each in sums])
    gaps = tuple(_gaps(wanted.frequency, _reasons(lines, np.max([each.excited for each in ready], axis=0))))
    late = ready[0].late / rate
    is_late = abs(late) <= LATEST
    matrix = _matrix(lines, wanted.frequency, gaps, late * is_late, about)
    return Found(matrix, wanted.frequency, gaps, tuple(ready), late, is_late)


def _wanted(config: RigConfig, correct_clock: bool) -> Wanted:
    low, high = config.characterisation.band
    lines = np.arange(np.ceil(low / SPACING), np.floor(high / SPACING) + 1) * SPACING
    factor = decimation(config)
    band = max(low - BEYOND, 1 / SHORTEST), min(high + BEYOND, 0.45 * config.audio.rate / factor)
    return Wanted(lines, band, factor, len(config.audio.drive_channels), correct_clock)


def _after(before: float, done: Callable[[float], object]) -> Callable[[float], object]:
    return lambda seconds: done(before + seconds)


def _turn_beside(
    sums: Sequence[Sum], own: Sequence[Sum], of: tuple[Prepared, Prepared], wanted: Wanted, rate: float
) -> np.ndarray:
    """Return by which phases a recording's responses are turned to lie beside those of the first, (lines,)."""
    first, each = of
    few = wanted.few
    stack = Stack.of([sums[0].at(few), own[0].at(few)])
    found = turned(stack, np.array([0.0, 1.0]), wanted.frequency[few], -LATEST, LATEST)
    later = each.late - first.late + found.value * rate
    if wanted.correct_clock:
        if not np.isfinite(found.error) and abs(each.late - first.late) > 2 * wanted.factor:
            raise FromRecordingsError(
                f"{each.name}: by how much its responses are later than those of {first.name} cannot be told, for "
                "other drives are at work: record all drives in one recording, or begin the files of each at once"
            )
        value = found.value if np.isfinite(found.error) else (first.late - each.late) / rate
        turn: np.ndarray = np.exp(2j * np.pi * wanted.frequency * value)
        return turn
    if found.is_told and abs(later) > LATER:
        raise FromRecordingsError(
            f"{each.name}: responses come {later / rate:.6f} s later beside their drives than in {first.name}, must be "
            "within a sample: begin the files of each recording together, or --correct-clock"
        )
    return np.ones(len(wanted.frequency))


def _matrix(
    lines: Lines, wanted: np.ndarray, gaps: Sequence[Gap], late: float, about: Mapping[str, str]
) -> TransferMatrix:
    """Keep the lines that have values, and put how late the responses were back into them."""
    there = np.ones(len(wanted), bool)
    for gap in gaps:
        there &= (wanted < gap.low) | (wanted > gap.high)
    if np.count_nonzero(there) < 4:
        more = f"; and {len(gaps) - TOLD} bands more" if len(gaps) > TOLD else ""
        raise FromRecordingsError(f"no model comes of this: {'; '.join(gap.text for gap in gaps[:TOLD])}{more}")
    response = (lines.response * np.exp(-2j * np.pi * wanted * late)[:, None, None])[there]
    floor = FLOOR**2 * (np.abs(response) ** 2).mean(axis=(1, 2), keepdims=True)
    variance = lines.variance[there] + floor
    coherence = np.broadcast_to(lines.coherence[there][:, :, None], variance.shape).copy()
    words = {**about, GAPS: json.dumps([[gap.low, gap.high, gap.reason] for gap in gaps])}
    return TransferMatrix(wanted[there], response, variance, coherence, words)


def _reasons(lines: Lines, excited: np.ndarray) -> list[str]:
    """Say of each line why it has no value; nothing where it has one."""
    silent = ~(excited > EXCITED * excited.max())
    squares = np.abs(lines.response) ** 2, lines.variance
    size, doubt = (around(square.sum(axis=(1, 2)), np.mean, WIDTH) for square in squares)
    unsure = ~(doubt <= UNKNOWN**2 * size)
    reasons = [""] * len(excited)
    weak = ~(excited > WEAK * excited.max())
    for first, last in stretches(unsure & ~weak.any(axis=1)):
        follows = float(np.median(lines.coherence[first:last].max(axis=1)))
        reasons[first:last] = [NOISE if follows >= FOLLOWS else UNRELATED] * (last - first)
    for line in np.flatnonzero(unsure & weak.any(axis=1)):
        reasons[line] = f"{_drives(weak[line])} hardly excited"
    together = ~(lines.together >= TOGETHER)
    for line in np.flatnonzero(together):
        reasons[line] = "the drives are correlated and not distinguishable"
    for line in np.flatnonzero(silent.any(axis=1)):
        reasons[line] = f"{_drives(silent[line])} not excited"
    return _without_edges(reasons)


def _drives(which: np.ndarray) -> str:
    """Name drives, (inputs,) of bool, and the verb to them."""
    numbers = [str(drive + 1) for drive in np.flatnonzero(which)]
    return f"drive {numbers[0]} is" if len(numbers) == 1 else f"drives {' and '.join(numbers)} are"


def _without_edges(reasons: list[str]) -> list[str]:
    """Call the few noisy lines beside a band that is not driven by that band's reason: they are its edge."""
    found = list(reasons)
    for first, last in stretches(np.array([reason in (NOISE, UNRELATED) for reason in reasons])):
        beside = [reasons[line] for line in (first - 1, last) if 0 <= line < len(reasons) and reasons[line]]
        if beside and last - first <= EDGE:
            found[first:last] = [beside[0]] * (last - first)
    return found


def _gaps(wanted: np.ndarray, reasons: Sequence[str]) -> Iterator[Gap]:
    first = 0
    for line in range(1, len(wanted) + 1):
        if line == len(wanted) or reasons[line] != reasons[first]:
            if reasons[first]:
                yield Gap(float(wanted[first]), float(wanted[line - 1]), reasons[first])
            first = line

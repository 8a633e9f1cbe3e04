"""One recording made ready: when its responses come, whose clock is faster, what it is, and its normal equations."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from calibration.recorded_blocks import Blocks, Wanted, clock_of_head, lead_of, read_periods
from calibration.recorded_clock import PASSES, Passes, Turn, lag
from calibration.recorded_period import Multisine, find_period
from calibration.recorded_response import Spectrum
from calibration.recorded_signals import BLOCK, SHORTEST, Course, Head, Recorded, block_length, blocks_of, head_of
from calibration.recorded_sum import Sum

SLIP = 0.25
"""Samples by which two clocks may differ from a recording's beginning to its end, as in a step of the learning ..."""
SAME_CLOCK = 0.5e-6
"""... and part, at most: resonances that move as a machine warms up look like as much."""
LEFT = 0.02
"""Samples by which they may differ once that is taken out."""
LATEST = 0.05
"""s by which responses may come later or earlier than drives ..."""
EARLY = 0.005
"""... and earlier without being moved: what a narrow band makes of a response that comes at once."""
APART = 0.02
"""s by which they may seem later in one recording than in another: resonances ring, and sweeps differ."""
LONG = 600.0
"""s: in a longer recording sweeps are slow, or many, and no line depends on where it is cut."""


class FromRecordingsError(ValueError):
    """Recordings from which no model comes."""


@dataclass(frozen=True)
class Prepared:
    """A recording made ready.

    Parameters
    ----------
    name : str
    seconds : float, s
        Of it that were read.
    late : int, samples
        By which responses come after drives; it is taken out.
    drift : Turn, 1
        Of the recorder's clock.
    is_corrected : bool
        Whether that is taken out.
    multisine : Multisine or None
    blocks : int
    excited : array, shape (lines, inputs), V sqrt(s)
        RMS of each drive around a line, of the block in which that is largest.
    levels : (array, array), shapes (inputs,) V and (outputs,) m/s^2
        RMS of drives and responses in the band.
    """

    name: str
    seconds: float
    late: int
    drift: Turn
    is_corrected: bool
    multisine: Multisine | None
    blocks: int
    excited: np.ndarray
    levels: tuple[np.ndarray, np.ndarray]


def prepared(
    record: Recorded, wanted: Wanted, late: int | None, done: Callable[[float], object]
) -> tuple[Prepared, list[Sum]]:
    """Read a recording and make it ready.

    Parameters
    ----------
    record : Recorded
    wanted : Wanted
    late : int or None, samples
        By which responses come after drives in another recording by the same devices.
    done : callable(float)
        Told of the seconds read.

    Returns
    -------
    about : Prepared
    sums : list of Sum
        Its equations at each of `REACHES`.

    Raises
    ------
    FromRecordingsError : too short, silent, or clocks that differ.
    RecordingError : the files cannot be read to their end, or a response is clipped or never changes.
    """
    head = head_of(record, wanted.factor)
    _refuse_unfit(record, head)
    period = find_period(head.drive, head.rate, wanted.factor)
    late = _late(record, head, wanted, period, late)
    drift = clock_of_head(head, late / wanted.factor, wanted)
    is_corrected = _is_to_be_corrected(record, drift, len(head.response) / head.rate, wanted)
    lead = round(record.rate * lead_of(head, late / wanted.factor, wanted))
    del head
    passes = Passes()
    for _ in range(PASSES):
        applied = drift.value if is_corrected else 0.0
        found: tuple[Blocks, Multisine | None] | None = None
        if period is not None:
            spectra = blocks_of(record, Course(late, applied, period, period, 0, True, wanted.band))
            found = read_periods(_told(spectra, done), period / record.rate, wanted)
        if found is None:
            period, found = None, (_read(record, _course(record, wanted, late, applied, lead), wanted, done), None)
        blocks, multisine = found
        rest = passes.take(applied, blocks.clock())
        if np.isfinite(rest.error):
            drift = passes.drift
        if not _is_to_be_corrected(record, rest, blocks.seconds, wanted, applied):
            break
        is_corrected = True
    return _about(record, wanted, blocks, multisine, (late, drift, is_corrected)), blocks.sums()


def _about(
    record: Recorded, wanted: Wanted, blocks: Blocks, multisine: Multisine | None, times: tuple[int, Turn, bool]
) -> Prepared:
    if not blocks.levels[0].any():
        raise FromRecordingsError(
            f"{record.drive.path}: silent from {wanted.band[0]:g} to {wanted.band[1]:g} Hz, must drive there"
        )
    read = blocks.seconds, *times, multisine, blocks.count, blocks.excited, blocks.levels
    return Prepared(record.name, *read)


def _read(record: Recorded, course: Course, wanted: Wanted, done: Callable[[float], object]) -> Blocks:
    """Add up a recording of any kind."""
    blocks = Blocks(wanted)
    cuts = 1 if course.hop == course.length else 2
    for number, block in enumerate(_told(blocks_of(record, course), done)):
        blocks.add(block, number % cuts)
    if not blocks.count:
        raise FromRecordingsError(f"{record.name}: shorter than {SHORTEST:g} s beside its drives, must be longer")
    return blocks


def _course(record: Recorded, wanted: Wanted, late: int, drift: float, lead: int) -> Course:
    frames, rate = record.response.frames, record.rate
    if frames is None:
        length = round(BLOCK * rate)
        return Course(late, drift, length, length // 2, lead, False, wanted.band)
    length = block_length(frames - abs(late) + lead, rate)
    is_cut = 1.5 * length < frames - abs(late) + lead and frames <= LONG * rate
    return Course(late, drift, length, length // 2 if is_cut else length, lead, False, wanted.band)


def _told(blocks: Iterator[Spectrum], done: Callable[[float], object]) -> Iterator[Spectrum]:
    """Tell after each block how many seconds were read."""
    for block in blocks:
        yield block
        done(block.middle + 0.5 / block.spacing)


def _refuse_unfit(record: Recorded, head: Head) -> None:
    played, heard = record.drive.frames, record.response.frames
    if played is not None and heard is not None and abs(played - heard) > 0.5 * max(played, heard):
        raise FromRecordingsError(
            f"{record.name}: {heard} samples, {record.drive.path} has {played}, must be nearly as many"
        )
    shortest = min(len(head.drive), len(head.response)) / head.rate
    if not shortest >= SHORTEST:
        raise FromRecordingsError(f"{record.name}: {shortest:.3g} s, must be at least {SHORTEST:g} s")


def _late(record: Recorded, head: Head, wanted: Wanted, period: int | None, known: int | None) -> int:
    """Return by how many samples responses come after drives, as many as are known from another recording."""
    found, rate = lag(head.drive, head.response, round(LATEST * head.rate)), record.rate
    late = 0 if found is None else wanted.factor * found
    if period is not None:
        late = (late + period // 2) % period - period // 2
    if -EARLY * rate < late < (0 if period is None else LATEST * rate):
        late = 0  # of a period in the end nothing is to be lost
    if known is not None:
        if found is not None and abs(late - known) > APART * rate:
            raise FromRecordingsError(
                f"{record.name}: responses come {late / rate:.3f} s after drives, and {known / rate:.3f} s in the "
                "first recording, must be the same: begin the files of each together, or --correct-clock"
            )
        return known
    if abs(late) > LATEST * rate and not wanted.correct_clock:
        raise FromRecordingsError(
            f"{record.name}: responses come {late / rate:.3f} s after drives, must be within {LATEST:g} s: cut "
            "the files so that they begin together, or take it out with --correct-clock"
        )
    return late


def _is_to_be_corrected(record: Recorded, drift: Turn, seconds: float, wanted: Wanted, applied: float = 0.0) -> bool:
    """Say whether a clock is to be taken out; refuse it where that is not asked for."""
    slip = abs(drift.value) * seconds * record.rate
    if applied:
        return slip > LEFT and abs(drift.value) > drift.error
    if not (drift.is_told and slip > SLIP and abs(drift.value) > SAME_CLOCK):
        return False
    if not wanted.correct_clock:
        raise FromRecordingsError(
            f"{record.name}: the recorder's clock is {drift.ppm} faster "
            "than the player's, must be the same: --correct-clock takes it out, or play and record by one device"
        )
    return True

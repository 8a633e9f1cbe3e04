"""What the blocks of one recording add up to as they are read, and what its beginning says of how to read it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calibration.recorded_clock import PASSES, Passes, Turn, clock
from calibration.recorded_period import Multisine, Periods
from calibration.recorded_response import REACHES, Evidence, Reach, Spectrum, evidence, noise_of
from calibration.recorded_signals import BLOCK, Head, lines_of, stretched
from calibration.recorded_sum import Sum

CLOCK_REACH = Reach(2, 2.0)
CLOCK_SPACING = 10.0
"""Hz between lines that a clock is found from, farther apart than their polynomials reach."""
PIECES = (4, 16)
"""Blocks, at least and at most, that the beginning is cut into for its clock ..."""
PIECE = 2.5
"""... and s of each, about."""
MOST = 64
"""Blocks that a clock is found from; of more every other one is left out, again and again."""
LEAD = 2.0
"""s of silence put before a recording that begins at rest: a sweep's first lines are told from a transient by it."""
AT_REST = 0.2
"""By so much the log of what is left may grow with that silence."""


@dataclass(frozen=True)
class Wanted:
    """What is asked of recordings.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz, evenly spaced
    band : (float, float), Hz
        Of the bins that are kept.
    factor : int
        By which the rate is lowered where time is looked at.
    inputs : int
    correct_clock : bool
        Whether clocks and beginnings that differ are taken out.
    """

    frequency: np.ndarray
    band: tuple[float, float]
    factor: int
    inputs: int
    correct_clock: bool

    @property
    def few(self) -> slice:
        """Some of the lines, as far apart as a clock wants them."""
        return slice(None, None, max(round(CLOCK_SPACING / float(self.frequency[1] - self.frequency[0])), 1))


class Blocks:
    """Adds up the blocks of a recording.

    A long recording is cut twice, the second time half a block later: a line that a sweep passes at a cut of the one
    lies in the middle of a block of the other, and at each line the cut that tells more counts.

    Parameters
    ----------
    wanted : Wanted
    """

    def __init__(self, wanted: Wanted) -> None:
        self._wanted = wanted
        self._cuts: tuple[dict[int, Sum], dict[int, Sum]] = {}, {}
        self._few: list[Evidence] = []
        self._middles: list[float] = []
        self._power: list[tuple[np.ndarray, np.ndarray]] = []
        self._every = 1
        self.count = 0
        """Blocks of the first cut."""
        self.seconds = 0.0
        """Of it."""
        self.excited = np.zeros((len(wanted.frequency), wanted.inputs))
        """RMS of each drive around a line, V sqrt(s), of the block in which that is largest."""

    def add(self, block: Spectrum, cut: int) -> None:
        """Take a block of the first cut, 0, or of the second, 1; the mean of periods that were looked at before."""
        if cut == 0 and not block.is_steady:
            self.look(block)
        sums, noise = self._cuts[cut], None
        for place, reach in reversed(list(enumerate(REACHES))):
            found = evidence(block, self._wanted.frequency, reach)
            noise = noise_of(found, REACHES[-1].width / reach.width, noise)
            if place not in sums:
                lines, coefficients, outputs = found.right.shape
                sums[place] = Sum.empty(lines, outputs, coefficients)
            sums[place].take(found, noise)
            excited = found.excited  # in the end those of the narrowest
        self.excited = np.maximum(self.excited, excited * np.sqrt(block.spacing))

    def look(self, block: Spectrum) -> None:
        """Take a block for the clock and the levels alone."""
        if self.count % self._every == 0:
            self._few.append(evidence(block, self._wanted.frequency[self._wanted.few], CLOCK_REACH))
            self._middles.append(block.middle)
        if len(self._few) == MOST:
            del self._few[1::2], self._middles[1::2]
            self._every *= 2
        self.count += 1
        power = (2 * block.spacing * (np.abs(each) ** 2).sum(axis=0) for each in (block.drive, block.response))
        drive, response = power
        self._power.append((drive, response))
        self.seconds += block.fresh / block.spacing

    @property
    def levels(self) -> tuple[np.ndarray, np.ndarray]:
        """RMS of drives, V, and responses, m/s^2, in the band."""
        drive, response = (np.sqrt(sum(each) / self.seconds) for each in zip(*self._power, strict=True))
        return drive, response

    def clock(self) -> Turn:
        """Find by how much the recorder's clock is faster."""

        def parts(count: int) -> Iterator[Sum]:
            return (Sum.of(each, noise_of(each)) for each in self._few[:count])

        return clock(parts, np.array(self._middles), self._wanted.frequency[self._wanted.few])

    def sums(self) -> list[Sum]:
        """Return the equations at each of `REACHES`."""
        first, second = self._cuts
        for place in list(second):
            first[place].improve(second.pop(place), self._wanted.inputs)
        return [first[place] for place in sorted(first)]


def read_periods(spectra: Iterator[Spectrum], period: float, wanted: Wanted) -> tuple[Blocks, Multisine] | None:
    """Add up a recording whose blocks are the periods of multisines; None where it is none.

    Parameters
    ----------
    spectra : iterator of Spectrum
        Not steady: all lines.
    period : float, s
    wanted : Wanted
    """
    periods, blocks = Periods(period), Blocks(wanted)
    for block in spectra:
        blocks.look(block)
        periods.add(block)
    found = periods.averaged()
    if found is None:
        return None
    means, told = found
    for mean in means:
        blocks.add(mean, 0)
    return blocks, told


def clock_of_head(head: Head, late: float, wanted: Wanted) -> Turn:
    """Find the clock from the beginning of a recording, in short blocks.

    Parameters
    ----------
    head : Head
    late : float, samples of it
    wanted : Wanted
    """
    passes = Passes()
    for _ in range(PASSES):
        applied = passes.drift.value
        rest = passes.take(applied, _shown_of_head(head, late, wanted, applied))
        if not abs(rest.value) > rest.error:
            break
    return passes.drift


def _shown_of_head(head: Head, late: float, wanted: Wanted, applied: float) -> Turn:
    drive, response = _beside(head, round(late))
    if applied:
        response = stretched(response, 1 + applied)
        drive = drive[: len(response)]
    count = int(np.clip(len(drive) / head.rate / PIECE, *PIECES))
    length, blocks = len(drive) // count, Blocks(wanted)
    for begin in range(0, count * length, length):
        taken = slice(begin, begin + length)
        middle = (begin + length / 2) / head.rate
        blocks.look(lines_of(drive[taken], response[taken], head.rate, wanted.band, middle))
    return blocks.clock()


def lead_of(head: Head, late: float, wanted: Wanted) -> float:
    """Return how much silence may be put before a recording, s: none where it does not begin at rest.

    Parameters
    ----------
    head : Head
    late : float, samples of it
    wanted : Wanted
    """
    if late < 0:
        return 0.0
    samples, few = round(BLOCK * head.rate), wanted.frequency[wanted.few]
    plain = [each[:samples] for each in _beside(head, round(late))]
    silent = [np.pad(each, ((round(LEAD * head.rate), 0), (0, 0))) for each in plain]
    left = []
    for drive, response in (plain, silent):
        found = evidence(lines_of(drive, response, head.rate, wanted.band, 0.0), few, CLOCK_REACH)
        left.append(float(np.mean(np.log(noise_of(found)))))
    return LEAD if left[1] <= left[0] + AT_REST else 0.0


def _beside(head: Head, late: int) -> Sequence[np.ndarray]:
    """Return drives and responses of the beginning beside each other."""
    first = max(0, -late)
    samples = min(len(head.drive) - first, len(head.response) - first - late)
    return head.drive[first : first + samples], head.response[first + late : first + late + samples]

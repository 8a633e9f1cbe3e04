"""The drive of a multisine record: a preload that every record repeats, and weak lines told apart by their phases."""

from dataclasses import dataclass

import numpy as np

from rigkit.fade import rise

FADE = 0.1
"""s, raised-cosine ends of a record; the first is part of the run-in."""
CREST_ROUNDS = 60
"""Times the preload is clipped and given its amplitudes back."""
CREST_CLIP = 0.85
"""Of its peak."""


@dataclass(frozen=True, eq=False)
class Design:
    """Everything that the records of a multisine have in common.

    Line l of input j has in record r the phase phase[l, j] + 2 pi code[l, j] r / records.  Over all records the codes
    are orthogonal, so each line can be read for one input at a time, free of whatever carries another code: the
    preload and its distortion, which are the same in every record, carry code 0.

    Parameters
    ----------
    period : int, samples
        Bins are counted in multiples of rate / period.
    rate : float, samples/s
    records : int
    bins : int array, shape (lines,)
        Excited.
    amplitude, phase : arrays, shape (lines, inputs), V, rad
    code : int array, shape (lines, inputs), 1 to records - 1
    preload : array, shape (period, 1 or inputs), V
        One column where all inputs have the same.
    working : tuple of ints
        First and last bin that the preload is meant to hold.
    run_in : int, samples
        Played before each period, so that the response is periodic when it is measured.
    """

    period: int
    rate: float
    records: int
    bins: np.ndarray
    amplitude: np.ndarray
    phase: np.ndarray
    code: np.ndarray
    preload: np.ndarray
    working: tuple[int, int]
    run_in: int

    @property
    def frequency(self) -> np.ndarray:
        """Of the excited lines, shape (lines,), Hz."""
        lines: np.ndarray = self.bins * self.rate / self.period
        return lines

    def one_period(self, number: int) -> np.ndarray:
        """Return one period of record `number`, shape (period, inputs), V."""
        turn = 2j * np.pi * number / self.records
        lines = self.amplitude * np.exp(1j * self.phase + turn * self.code)
        signal: np.ndarray = lines_to_time(self.bins, lines, self.period) + self.preload
        return signal


@dataclass(frozen=True, eq=False)
class Record:
    """One record as a batch: run-in, one period, and a fade to rest.

    Parameters
    ----------
    design : Design
    number : int, counted from 0
    """

    design: Design
    number: int

    @property
    def window(self) -> slice:
        """Where the measured period lies."""
        return slice(self.design.run_in, self.design.run_in + self.design.period)

    @property
    def samples(self) -> int:
        """Length of the drive."""
        return self.design.run_in + self.design.period + round(FADE * self.design.rate)

    def drive(self) -> np.ndarray:
        """Return the drive, shape (samples, inputs), V, from rest to rest."""
        period = self.design.one_period(self.number)
        drive: np.ndarray = period[(np.arange(self.samples) - self.design.run_in) % self.design.period]
        fade = round(FADE * self.design.rate)
        up = rise(fade)[:, None]
        drive[:fade] *= up
        drive[len(drive) - fade :] *= up[::-1]
        return drive


def odd_lines(first: int, last: int, group: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Choose odd bins to excite, leaving out one at random in each group for odd-order distortion to show.

    Parameters
    ----------
    first, last : int
        Bins, both ends included.
    group : int, >= 2
        Odd lines in a group.
    rng : Generator

    Returns
    -------
    excited, detection : int arrays, rising

    Source
    ------
    Pintelon and Schoukens 2012, System Identification, sec. 4.3: odd random-phase multisines, random harmonic grid.

    Examples
    --------
    >>> excited, detection = odd_lines(1, 15, 4, np.random.default_rng(0))
    >>> len(excited), len(detection), bool(np.all(excited % 2))
    (6, 2, True)
    """
    odd = np.arange(first + 1 - first % 2, last + 1, 2)
    starts = np.arange(0, len(odd) - group + 1, group)
    left_out = starts + rng.integers(0, group, len(starts))
    return np.delete(odd, left_out), odd[left_out]


def codes(lines: int, inputs: int, records: int) -> np.ndarray:
    """Give each line and input a column of the DFT over the records, neighbours different ones.

    Parameters
    ----------
    lines, inputs : int
    records : int, > inputs

    Returns
    -------
    int array, shape (lines, inputs), 1 to records - 1
        Different within a line, and from the next (records - 1) // inputs - 1 lines.

    Source
    ------
    Dobrowiecki, Schoukens and Guillaume 2006, "Optimized excitation signals for MIMO frequency response function
    measurements", IEEE Trans. Instrum. Meas. 55(6): orthogonal multisines by the DFT matrix.

    Examples
    --------
    >>> codes(3, 2, 8).tolist()
    [[1, 2], [3, 4], [5, 6]]
    """
    if not records > inputs:
        raise ValueError(f"{records} records, must be more than {inputs} for {inputs} inputs")
    block = np.arange(lines) % ((records - 1) // inputs)
    return 1 + block[:, None] * inputs + np.arange(inputs)


def low_crest(bins: np.ndarray, period: int, rms: float, rng: np.random.Generator) -> np.ndarray:
    """Return a periodic signal of equally strong lines that comes close to its rms in its peaks.

    Parameters
    ----------
    bins : int array, shape (lines,)
    period : int, samples
    rms : float, V
    rng : Generator
        Draws the phases it starts from.

    Returns
    -------
    array, shape (period,), V

    Source
    ------
    Van der Ouderaa, Schoukens and Renneboog 1988, "Peak factor minimization using a time-frequency domain swapping
    algorithm", IEEE Trans. Instrum. Meas. 37(1).
    """
    signal = lines_to_time(bins, np.exp(1j * crest_phases(bins, np.ones(len(bins)), rng)), period)
    scaled: np.ndarray = rms / np.sqrt(np.mean(signal**2)) * signal
    return scaled


def crest_phases(bins: np.ndarray, amplitude: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return phases, (lines,), rad, by which lines of these amplitudes come close to their rms in their peaks.

    Parameters
    ----------
    bins : int array, shape (lines,)
    amplitude : array, shape (lines,), 1
    rng : Generator
        Draws the phases it starts from.
    """
    phase: np.ndarray = 2 * np.pi * rng.random(len(bins))
    grid = 1 << int(np.ceil(np.log2(16 * bins.max())))  # peaks are looked for on a coarser one
    for _ in range(CREST_ROUNDS):
        signal = lines_to_time(bins, amplitude * np.exp(1j * phase), grid)
        limit = CREST_CLIP * np.abs(signal).max()
        phase = np.angle(np.fft.rfft(np.clip(signal, -limit, limit))[bins])
    return phase


def lines_to_time(bins: np.ndarray, lines: np.ndarray, samples: int) -> np.ndarray:
    """Return one period of lines of complex amplitudes, (lines, ...), as samples, (samples, ...)."""
    spectrum = np.zeros((samples // 2 + 1, *lines.shape[1:]), complex)
    spectrum[bins] = samples / 2 * lines
    signal: np.ndarray = np.fft.irfft(spectrum, samples, axis=0)
    return signal

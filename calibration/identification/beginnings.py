"""Drives and responses in two files, begun at other moments or by other clocks: found, told, and taken out if asked."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calibration.identification.recordings import Measured
from calibration.recorded_blocks import Wanted, clock_of_head
from calibration.recorded_clock import UNKNOWN, Turn, lag
from calibration.recorded_pair import SLIP
from calibration.recorded_signals import Head
from ctlblocks.recording import Recording
from vibractl.foreign.near import moved

FEW = 8
"""Samples, at the rate of the model, by which a delay may be wrong, and that are left where it is taken out: an impulse
response may begin before it is strong.  Fewer are not worth a word."""
RINGING = 100
"""Samples by which the strongest part of an impulse response may come after its beginning."""
PIECE, SHORTEST, LONGEST = 1_000, 10.0, 40.0
"""Samples of a recording that are taken for a second where its clock is looked for: that way of looking has its widths
in Hz, made for vibrators; and all of it for so many s, at least and at most."""
LINES, SPACING, FEWEST = 200, 10.0, 8
"""At which it is looked at most, Hz between them at least, and how many there must be."""
HIGHEST = 0.75
"""Of half the rate."""
PART, MARGIN = 2**18, 64
"""Samples moved at once, and those beside that a spline sees of the others."""


@dataclass(frozen=True)
class Beginning:
    """How the responses of a recording lie beside its drives.

    Parameters
    ----------
    late : int, samples
        By which they come after the drives, where they are most alike; 0 where that is not shown.
    drift : Turn, 1
        By which the recorder's clock is faster than the player's.
    """

    late: int
    drift: Turn


def beginning(drive: np.ndarray, response: np.ndarray) -> Beginning:
    """Find delay and clock.

    Parameters
    ----------
    drive : array, shape (N, inputs), any unit
    response : array, shape (N, outputs), any unit
    """
    drive, response = drive - drive.mean(axis=0), response - response.mean(axis=0)
    late = lag(drive, response, RINGING) or 0
    rate = len(drive) / float(np.clip(len(drive) / PIECE, SHORTEST, LONGEST))
    spacing = max(SPACING, HIGHEST * rate / 2 / LINES)
    lines = np.arange(spacing, HIGHEST * rate / 2, spacing)
    if len(lines) < FEWEST or not len(drive) > abs(late) + PIECE:
        return Beginning(late, UNKNOWN)
    wanted = Wanted(lines, (spacing / 2, 0.45 * rate), 1, drive.shape[1], False)
    return Beginning(late, clock_of_head(Head(drive, response, rate), late, wanted))


def begun_together(measured: Measured, thin: Sequence[Recording], factor: int, correct: bool) -> Measured:
    """Look at the recordings whose drives and responses are in two files; take delays and clocks out if asked.

    Parameters
    ----------
    measured : Measured
    thin : sequence of Recording
        The same at the model's rate.
    factor : int
        By which that is lower.
    correct : bool

    Raises
    ------
    ValueError : clocks that differ, and are not to be corrected.
    """
    recordings, notes = list(measured.recordings), list(measured.notes)
    first = 0
    for number, is_apart in enumerate(measured.is_apart):
        if not is_apart:
            continue
        name, inputs, (data, rate) = measured.names[number], measured.inputs, (thin[number].data, thin[number].rate)
        found = beginning(data[:, :inputs], data[:, inputs:])
        drift = _refused_or_taken(found, len(data), name, correct)
        late = first = first if number and abs(found.late - first) <= FEW else found.late
        taken = late - FEW if correct and abs(late) > FEW else 0
        notes += [_delay(name, late, rate, taken)] if abs(late) > FEW else []
        notes += [f"{name}: the recorder's clock is {found.drift.ppm} faster, which is taken out"] if drift else []
        if taken or drift:
            recordings[number] = _beside(recordings[number], inputs, factor * taken, drift)
    return replace(measured, recordings=tuple(recordings), notes=tuple(notes))


def _refused_or_taken(found: Beginning, samples: int, name: str, correct: bool) -> float:
    """Return the difference of clocks that is to be taken out; refuse one where that is not asked for."""
    slip = abs(found.drift.value) * samples
    if not (found.drift.is_told and slip > SLIP):
        return 0.0
    if not correct:
        raise ValueError(
            f"{name}: the recorder's clock is {found.drift.ppm} faster than the player's, {slip:.2g} samples in the "
            f"end, must be within {SLIP:g}: --correct-clock takes it out, or play and record by one device"
        )
    return found.drift.value


def _delay(name: str, late: int, rate: float, taken: int) -> str:
    place = "after" if late > 0 else "before"
    comes = f"{name}: responses come about {abs(late)} samples ({abs(late) / rate:.4g} s) {place} their drives"
    if taken:
        return f"{comes}, which is taken out but for {FEW} samples after them"
    if late > 0:
        return f"{comes}, and the model takes a state for each: --correct-clock takes them out"
    return f"{comes}, which no model has: begin both files together, or --correct-clock"


def _beside(recording: Recording, inputs: int, late: int, drift: float) -> Recording:
    """Put responses by the drives' clock, and so many samples earlier."""
    drive, response = recording.data[:, :inputs], recording.data[:, inputs:]
    first, stretch = max(0, -late), 1 + drift
    count = min(len(drive) - first, int((len(response) - 1) / stretch) - late - first)
    heard = _read_at(response, first + late, stretch, count) if drift else response[first + late :][:count]
    words = {"moved": f"{late} samples", "clock": f"{drift:.4g}"}
    data = np.hstack((drive[first : first + count], heard))
    return replace(recording, data=data, provenance={**recording.provenance, **words})


def _read_at(signal: np.ndarray, first: int, stretch: float, count: int) -> np.ndarray:
    """Read a signal at `stretch` (`first` + n), a part at a time."""
    parts = []
    for begin in range(0, count, PART):
        places = stretch * (first + np.arange(begin, min(begin + PART, count)))
        low, high = max(int(places[0]) - MARGIN, 0), int(places[-1]) + MARGIN
        parts.append(moved(signal[low:high], places - low))
    return np.concatenate(parts)

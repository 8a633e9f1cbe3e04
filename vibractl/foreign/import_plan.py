"""The shots in recordings of other software, found and examined before anything is written."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError
from vibractl.foreign.estimate import Estimate, mean, slope
from vibractl.foreign.examination import Examined, Examiner
from vibractl.foreign.placing import Placed, Placing
from vibractl.foreign.recorded import Recorded
from vibractl.foreign.sample_faults import SampleFault, SampleFaults
from vibractl.foreign.shot_search import LIKE, ShotSearch, Sighting
from vibractl.foreign.slow_view import SlowView, slow_factor
from vibractl.judging import Judging
from vibractl.setup import Setup
from vibractl.transfer_matrix import TransferMatrix

SEVERAL = 3
"""Shots in one recording, from which its clock is told by how their delay grows."""
TRIES = 3
"""Shots at which wires are looked at, where the first does not tell."""


@dataclass(frozen=True, eq=False)
class FoundShot:
    """A shot.

    Parameters
    ----------
    number : int, counted from 0
    recorded : Recorded
    seen : Examined
    placed : Placed
    """

    number: int
    recorded: Recorded
    seen: Examined
    placed: Placed


@dataclass(frozen=True, eq=False)
class Scanned:
    """What a recording holds.

    Parameters
    ----------
    recorded : Recorded
    shots : tuple of FoundShot
    faults : tuple of SampleFault
        Anywhere in it.
    clock : Estimate or None, ppm
        By how much the recorder's clock is faster than the player's; None where nothing tells.
    """

    recorded: Recorded
    shots: tuple[FoundShot, ...]
    faults: tuple[SampleFault, ...]
    clock: Estimate | None


@dataclass(frozen=True, eq=False)
class _Read:
    """A recording that was read, before its shots are placed."""

    recorded: Recorded
    seen: tuple[Examined, ...]
    faults: tuple[SampleFault, ...]
    begins: float


def scan(
    recordings: Sequence[Recorded],
    made: Setup | Judging,
    matrix: TransferMatrix | None,
    delay: float | None,
    tell: Callable[[int], None],
) -> list[Scanned]:
    """Find and examine all shots of recordings, in order.

    Parameters
    ----------
    recordings : sequence of Recorded
    made : Setup, or Judging without a model
    matrix : TransferMatrix or None
        Of the whole rig.
    delay : float or None, samples
        By which responses come after drives, where a person knows it.
    tell : callable
        Called with the number of samples read, of all recordings.

    Raises
    ------
    RecordingError : a sample that is none, a channel that is dead, or no shot in a recording.
    """
    factor, read = slow_factor(made.reference.signal, made.shot.rate), []
    wires = _Wires()
    done = 0
    for recorded in recordings:
        examiner, faults = Examiner(recorded, made, matrix, factor), SampleFaults(recorded.full_scale)
        search = ShotSearch(examiner.probes, examiner.rate, examiner.before, examiner.after)
        seen = [
            wires.noted(examiner.examined(each, wires.are_wanted))
            for each in _sightings(recorded, search, faults, factor, _Told(tell, done))
        ]
        _refuse_dead(recorded, faults, made)
        if not seen:
            if recorded.frames < made.shot.frames:
                raise RecordingError(
                    f"{recorded.name}: {recorded.frames} samples, must be at least {made.shot.frames}: the "
                    f"reference and {made.shot.rest} after it in which the vibrator comes to rest"
                )
            what = "drive in its monitors" if recorded.widths[2] else "reference"
            raise RecordingError(
                f"{recorded.name}: does not hold the {what}: correlation {search.best:.2f} where they are most alike, "
                f"must be >= {LIKE:g}"
            )
        read.append(_Read(recorded, tuple(seen), tuple(faults.end()), examiner.begins))
        done += recorded.frames
    return list(_placed(read, made, delay))


@dataclass(frozen=True)
class _Told:
    """Tells how many samples are read, beside those of the recordings before."""

    tell: Callable[[int], None]
    before: int

    def show(self, done: int) -> None:
        self.tell(self.before + done)


class _Wires:
    """Whether wires are still to be looked at."""

    def __init__(self) -> None:
        self._tries, self.are_wanted = 0, True

    def noted(self, seen: Examined) -> Examined:
        """Take what was found, and give it back."""
        self._tries += 1
        is_sure = all(each is not None and each.is_sure for each in (seen.drives, seen.responses))
        self.are_wanted = self.are_wanted and not is_sure and self._tries < TRIES
        return seen


def _placed(read: Sequence[_Read], made: Setup | Judging, delay: float | None) -> Iterator[Scanned]:
    """Place the shots of all recordings."""
    placing = Placing(made.shot.lead, delay, [(seen, each.recorded) for each in read for seen in each.seen])
    number = 0
    for each in read:
        shots = []
        for seen in each.seen:
            shots.append(FoundShot(number, each.recorded, seen, placing.placed(seen, each.recorded, each.begins)))
            number += 1
        yield Scanned(each.recorded, tuple(shots), each.faults, _clock(shots))


def _sightings(
    recorded: Recorded, search: ShotSearch, faults: SampleFaults, factor: int, told: _Told
) -> Iterator[Sighting]:
    """Read a recording once, from beginning to end."""
    stream, done = SlowView(factor, len(recorded.full_scale)), 0
    for block in recorded.blocks():
        faults.follow(block)
        yield from search.follow(stream.follow(block))
        done += len(block)
        told.show(done)
    yield from search.follow(stream.end())
    yield from search.end()


def _refuse_dead(recorded: Recorded, faults: SampleFaults, made: Setup | Judging) -> None:
    """Refuse a recording in which a sensor that is controlled, or all drives, never move."""
    dead = np.flatnonzero(faults.dead)
    heard = [recorded.heard.start + side for side in made.places[0].sensors]
    played = np.arange(recorded.widths[0]) if recorded.is_beside else np.zeros(0, dtype=int)
    for column in (*heard, *(played if np.isin(played, dead).all() else ())):
        if column in dead:
            name = f"response {column - recorded.heard.start + 1}" if column in heard else f"drive {column + 1}"
            raise RecordingError(
                f"{recorded.name}: {name} has one value throughout, must move: a dead channel, or --map names another"
            )


def _clock(shots: Sequence[FoundShot]) -> Estimate | None:
    """Return by how much the recorder's clock is faster, of all that tells it the surest."""
    told = [shot.seen.clock for shot in shots if shot.seen.clock is not None]
    if not told:
        return None
    found = mean(told)
    late = [shot.seen.late for shot in shots if shot.seen.late is not None]
    if shots[0].recorded.is_beside and len(shots) >= SEVERAL and len(late) == len(shots):
        grown = slope([1e-6 * shot.seen.played.value for shot in shots], late)
        found = grown if grown.error < found.error else found
    return found

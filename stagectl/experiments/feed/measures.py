"""What a milled pocket comes to: times, feeds and forces, in all and by type of strip."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.feed.held_force import BRAKING, held
from stagectl.experiments.feed.noticed import noticed
from stagectl.experiments.feed.pocketed import Pocketed
from stagectl.experiments.feed.process_run import channel
from stagectl.planning.milling import Milled, finished
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, costs, legal, place, untouched
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.feed_notices import NAMES, NOTICES
from stagectl.robot.milling.feed_record import CONTROLLING


@dataclass(frozen=True, eq=False)
class Strip:
    """A finished segment as it was milled.

    Parameters
    ----------
    name : str
        Its type.
    duration, moved : float, s
        Of the milling, and of the way there.
    length : float, m
    slowest : float, m/s
        Lowest mean of the feed over some time, while it was controlled; NaN where it was so for a shorter time.
    forces : array, shape (samples,), N
        The resultant while it was stationary.
    """

    name: str
    duration: float
    moved: float
    length: float
    slowest: float
    forces: np.ndarray


def runs(record: Recording) -> list[slice]:
    """Return the samples of each segment that was milled, in their order; the last may not be finished."""
    edges = np.diff(np.concatenate([[0.0], channel(record, "is_running"), [0.0]]))
    return [slice(*each) for each in zip(np.flatnonzero(edges > 0.5), np.flatnonzero(edges < -0.5), strict=True)]


def strips(done: Pocketed, cell: CellConfig) -> list[Strip]:
    """Return the finished segments of a pocket.

    Parameters
    ----------
    done : Pocketed
    cell : CellConfig
    """
    record, task = done.recording, cell.segments
    place = record.select(["place_x", "place_y"]).data
    feed = np.hypot(*np.diff(place, axis=0, prepend=place[:1]).T) * record.rate
    controlled = channel(record, "phase") == CONTROLLING
    resultant = channel(record, "resultant")
    window, settled, braked = (round(each * record.rate) for each in (task.slowest, task.stationary, BRAKING))
    found: list[Strip] = []
    last = 0
    for milled, run in zip(done.segments, runs(record), strict=False):
        on = np.flatnonzero(controlled[run]) + run.start
        free = feed[on[settled : len(on) - braked]]
        slowest = np.convolve(free, np.full(window, 1.0 / window), "valid").min() if len(free) >= window else np.nan
        length = float(np.hypot(*(place[min(run.stop, len(place) - 1)] - place[run.start])))
        moved = (run.start - last) / record.rate if found else 0.0
        forces = resultant[on[settled:]]
        found.append(Strip(milled.name, milled.duration, moved, length, float(slowest), forces))
        last = run.stop
    return found


def as_milled(done: Pocketed) -> list[Milled]:
    """Return the finished segments with the time of the way to each as it was, not as it was believed."""
    whole, rate = runs(done.recording), done.recording.rate
    before = [0.0, *((after.start - run.stop) / rate for run, after in zip(whole, whole[1:], strict=False))]
    return [replace(each, moved=float(moved)) for each, moved in zip(done.segments, before, strict=False)]


def retold(record: Recording, pocket: Pocket, path: Sequence[Sequence[Any]] | None = None) -> tuple[Milled, ...]:
    """Return the finished segments of a recorded pocket.

    Parameters
    ----------
    record : Recording
    pocket : Pocket
    path : sequence of sequences, optional
        Type, row, column and feed of each, where the recording does not have what was chosen.
    """
    standing, cost, found = untouched(pocket), costs(pocket), []
    ends = np.flatnonzero(channel(record, "is_finished") > 0.5)
    durations, deviations = (channel(record, name)[ends] for name in ("duration", "force_deviation"))
    chosen = record.select(["cut_1", "cut_2"]).data[ends].astype(int).tolist() if path is None else path
    for told, duration, deviation in zip(chosen, durations, deviations, strict=False):
        if path is None:
            cut = Cut(*told)
        else:
            cuts = (each for each in legal(standing, cost) if each.name(pocket.G) == told[0])
            cut = next(each for each in cuts if place(each, standing, cost) == tuple(told[1:3]))
        milled = finished(cut, standing, cost)
        found.append(replace(milled, duration=float(duration), force_deviation=float(deviation)))
        standing = milled.leaves()
    return tuple(found)


def chosen(record: Recording) -> list[Cut]:
    """Return every strip that a recorded pocket took up, the last one finished or not."""
    number = channel(record, "number")
    taken = np.flatnonzero((np.diff(number, prepend=0.0) != 0.0) & (number > 0.0))
    return [Cut(*each) for each in record.select(["cut_1", "cut_2"]).data[taken].astype(int).tolist()]


def safe_feeds(milled: Iterable[Strip], types: Sequence[str]) -> dict[str, float]:
    """Return the feed of each type that position control can count on: the lowest that force control had, m/s.

    A type that was not milled, or not for long enough, has the lowest of all.

    Raises
    ------
    ValueError : no segment was controlled for long enough.

    Source
    ------
    Sörnmo 2015, sec. 7.3: "the minimum velocity for each milling type, obtained during a force-controlled pocket
    milling".
    """
    found: dict[str, float] = {}
    for each in milled:
        if np.isfinite(each.slowest):
            found[each.name] = min(found.get(each.name, np.inf), each.slowest)
    if not found:
        raise ValueError("no segment was under force control for long enough to determine a safe feed")
    least = min(found.values())
    return {name: found.get(name, least) for name in types}


def figures(done: Pocketed, cell: CellConfig) -> dict[str, Any]:
    """Return what a pocket comes to, other programs' keys.

    Parameters
    ----------
    done : Pocketed
    cell : CellConfig

    Returns
    -------
    dict
        `fault` (or null), `segments`, `seconds` from the beginning of the first segment to the end of the last,
        `milling` (s, of these in segments), `force_mean`, `force_deviation` (N, while stationary), `force_peak` (N),
        `force_error` (1, size of its mean error over the force wanted), `force_settled` (s, the longest from the
        beginning of control in a segment until the mean over 0.1 s stays within 10 % in the first second),
        `force_overshoot` (1, largest force in a segment over the one wanted; null where nothing was controlled),
        `notices`: a list of `time` (s), `segment` and `what`, as `noticed` has them, and `noticed`: how often, by name;
        `types`: by type `segments`, `duration` (s, mean), `feed`, `slowest_feed` (m/s), `force_mean`,
        `force_deviation` (N).
    """
    milled, notices = strips(done, cell), noticed(done.recording)
    by_type: dict[str, list[Strip]] = {}
    for each in milled:
        by_type.setdefault(each.name, []).append(each)
    return {
        "fault": done.reason or None,
        "segments": len(milled),
        "seconds": sum(each.duration + each.moved for each in milled),
        "milling": sum(each.duration for each in milled),
        **_force(milled),
        "force_peak": float(channel(done.recording, "resultant").max()),
        **held(done.recording, cell),
        "notices": [asdict(each) for each in notices],
        "noticed": {NAMES[bit]: sum(each.what == text for each in notices) for bit, text in NOTICES.items()},
        "types": {name: _of_type(each) for name, each in sorted(by_type.items())},
    }


def _of_type(milled: list[Strip]) -> dict[str, Any]:
    duration = sum(each.duration for each in milled)
    slowest = [each.slowest for each in milled if np.isfinite(each.slowest)]
    return {
        "segments": len(milled),
        "duration": duration / len(milled),
        "feed": sum(each.length for each in milled) / duration,
        "slowest_feed": min(slowest) if slowest else None,
        **_force(milled),
    }


def _force(milled: list[Strip]) -> dict[str, float | None]:
    forces = np.concatenate([each.forces for each in milled]) if milled else np.zeros(0)
    if len(forces) < 2:
        return {"force_mean": None, "force_deviation": None}
    return {"force_mean": float(forces.mean()), "force_deviation": float(forces.std(ddof=1))}

"""Systems drawn by seed, identified with no option given: how much of the response is missed, and what is said of it.

`python -m benchmarks.identification_population [FIRST] [--write]`, 120 records, a quarter of an hour on two cores;
prints a table, and with --write puts it into docs/validation/identification.md.  Beside the default stands what it was
before loops, dead time, outliers and horizons were looked for: horizon 20 and MOESP, all told.

Missed: root mean square of the frequency response's error over that of the response, all channels, at those of 200
frequencies up to 0.48 of the rate, geometric from a thousandth of it on, at which every input has at least a thousandth
of its mean power density; nobody knows the rest.  Damping: largest relative error of those of the truth's resonances
there that have a ratio below 0.3, each against the model's that is nearest in frequency.  Covered: part of the
magnitudes there within 1.96 standard errors.
"""

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, table, words
from calibration import subspace
from calibration.state_space import InnovationModel
from firmware_sim.plants.linear_system import LinearSystem
from firmware_sim.population.signals import SYSTEMS, SignalSource, signal

FIRST, COUNT = 5320, 120
FREQUENCY = np.geomspace(1e-3, 0.48, 200)
"""Of the rate."""
SURE, LIGHT = 1.96, 0.3
FAINT, SMOOTH = 1e-3, 0.02
"""Power density re its mean that still counts as driven; of the rate, how wide it is averaged."""
BEFORE = {"horizon": 20, "method": "moesp", "delay": 0, "outliers": "keep"}


@dataclass(frozen=True)
class Outcome:
    """What came of a record; infinite where it was refused."""

    groups: tuple[str, ...]
    missed: float = np.inf
    before: float = np.inf
    order: int = 0
    true_order: int = 0
    damping: float = np.nan
    covered: float = np.nan
    seconds: float = np.nan
    refused: str = ""


def outcome(seed: int) -> Outcome:
    """Identify the record of a seed both ways."""
    source = signal(list(SYSTEMS)[seed % len(SYSTEMS)], seed)
    truth, groups = source.truth, _groups(source)
    try:
        record = source.record()
    except ValueError as fault:
        return Outcome((), refused=str(fault))  # no record to be judged by
    before, at = np.inf, truth.rate * _driven(record.given)
    if len(at) == 0:
        return Outcome((), refused="its inputs drive at no frequency together")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            before = _missed(subspace.identify(record.given, record.measured, truth.rate, **BEFORE).model, truth, at)  # type: ignore[arg-type]  # options
        except ValueError:
            pass
        begun = time.process_time()
        try:
            found = subspace.identify(record.given, record.measured, truth.rate)
        except ValueError as fault:
            return Outcome(groups, before=before, true_order=len(truth.dynamics), refused=str(fault))
        seconds = time.process_time() - begun
        answer, right = (each(at) for each in (found.model.frequency_response, truth.response))
        off = np.abs(np.abs(answer) - np.abs(right))
        covered = float(np.mean(off < SURE * found.response_errors(at).magnitude))
    return Outcome(
        groups,
        _missed(found.model, truth, at),
        before,
        found.core.order,
        len(truth.dynamics),
        _damping_error(found.model, truth, at),
        covered,
        seconds,
    )


def _groups(source: SignalSource) -> tuple[str, ...]:
    """Say which rows a record counts in."""
    plain = "nothing else" if not source.mixed else "something else"
    special = [each for each in ("closed loop", "dead time", "integrators", "unstable pole") if each in source.mixed]
    spoiled = set(source.mixed) - {"closed loop", "dead time", "integrators", "unstable pole"}
    loud = "noise 20 dB below or more" if source.clear > 20.0 else "nearer noise"
    return ("all", source.family, plain, *special, *(["spoiled"] if spoiled else []), loud)


def _driven(given: np.ndarray) -> np.ndarray:
    """Return those of `FREQUENCY` at which every input drives, in the longest stretch without a gap."""
    gaps = np.flatnonzero(~np.isfinite(given).all(axis=1))
    stretch = max(np.split(given, gaps), key=len)
    signal = stretch[np.isfinite(stretch).all(axis=1)]
    signal = (signal - signal.mean(axis=0)) * np.hanning(len(signal))[:, None]
    power = np.abs(np.fft.rfft(signal, axis=0)) ** 2
    around = max(1, round(SMOOTH * len(signal)))
    density = np.array([np.convolve(each / each.mean(), np.ones(around) / around, "same") for each in power.T])
    driven: np.ndarray = FREQUENCY[(density[:, (FREQUENCY * len(signal)).astype(int)] > FAINT).all(axis=0)]
    return driven


def _missed(model: InnovationModel, truth: LinearSystem, at: np.ndarray) -> float:
    right = truth.response(at)
    return float(np.linalg.norm(model.frequency_response(at) - right) / np.linalg.norm(right))


def _damping_error(model: InnovationModel, truth: LinearSystem, at: np.ndarray) -> float:
    """Return it, or no number where nothing of the truth rings there."""
    natural, damping = _resonances(truth.poles, truth.rate)
    inside = (natural >= at.min()) & (natural <= at.max())
    natural, damping = natural[inside], damping[inside]
    found, damped = _resonances(model.poles, model.rate)
    if len(natural) == 0:
        return np.nan
    if len(found) == 0:
        return np.inf
    nearest = np.abs(found[None] - natural[:, None]).argmin(axis=1)
    return float(np.max(np.abs(damped[nearest] / damping - 1.0)))


def _resonances(poles: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return natural frequencies, Hz, and damping ratios of the poles that ring."""
    logarithms = np.log(poles[poles.imag > 0].astype(complex)) * rate
    natural, damping = np.abs(logarithms) / (2 * np.pi), -logarithms.real / np.abs(logarithms)
    rings = (damping > 0) & (damping < LIGHT)
    return natural[rings], damping[rings]


def _row(name: str, found: Sequence[Outcome]) -> list[str]:
    done = [each for each in found if not each.refused]

    def spread(field: str) -> str:
        values = np.array([getattr(each, field) for each in done], float)
        values = values[~np.isnan(values)]
        if len(values) == 0:
            return "-"
        median, most, worst = np.quantile(values, [0.5, 0.95, 1.0], method="higher")
        return f"{median:.3g}, {most:.3g}, {worst:.3g}"

    right = [abs(each.order - each.true_order) <= 1 for each in done]
    covered = 100 * np.array([each.covered for each in done])
    cells = [spread("missed"), spread("before"), f"{sum(right)}", spread("damping")]
    middle = f"{np.nanmedian(covered):.0f}, {np.nanquantile(covered, 0.05):.0f}" if done else "-"
    return [name, str(len(found)), str(len(found) - len(done)), *cells, middle, spread("seconds")]


def main() -> None:
    """Print the table, and write it."""
    first = int((words() or [str(FIRST)])[0])
    found = []
    for seed, each in zip(range(first, first + COUNT), over_seeds(outcome, range(first, first + COUNT)), strict=True):
        print(seed, each, flush=True)
        found.append(each)
    names = list(dict.fromkeys(group for each in found for group in each.groups))
    names.sort(key=lambda name: (name != "all", name))
    rows = [_row(name, [each for each in found if name in each.groups]) for name in names]
    three = "median, 95 %, worst"
    head = [
        *("records", "N", "refused", f"response missed, {three}", "as it was before", "order within 1"),
        *("damping off", "covered, %: median, 5 %", "processor, s"),
    ]
    put(table(head, rows), "validation/identification.md", "drawn systems")


if __name__ == "__main__":
    main()

"""Gain, time constant and dead time of a manipulator from its response to steps or to a multisine."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.optimize import least_squares

from ctlblocks.recording import Recording
from rigkit.config import Section, setting

MANIPULATORS = {"robot": "slow", "stage": "fast"}
"""What the pair of mid-ranging calls each."""
REST = 1.0
"""s before the first step, and between robot and stage."""
LATEST = 0.25
"""Longest dead time, of a period: by half of one a step up is a step down."""
NUMBERS = ("gain", "time_constant", "delay")


class Wanted(Section):
    """What is asked of which manipulator."""

    of: Literal["both", "robot", "stage"] = setting("both", "", "which manipulator: both, one after the other")
    kind: Literal["step", "multisine"] = setting("step", "", "what is asked")
    size: float = setting(0.5e-3, "m", "of the steps, or the peak of the multisine", gt=0, le=0.1)
    period: float = setting(8.0, "s", "of the steps, up and down, or of the multisine", ge=0.1, le=600)
    repeats: int = setting(4, "periods", "of each manipulator; a multisine has one more ahead of them", ge=2, le=100)
    highest: float = setting(20.0, "Hz", "bin of the multisine", gt=0, le=1000)

    @property
    def manipulators(self) -> list[str]:
        """Of `MANIPULATORS`, in their order."""
        return [name for name in MANIPULATORS if self.of in ("both", name)]

    def excitation(self, rate: float) -> np.ndarray:
        """Return what one manipulator is asked, from rest to rest, shape (samples,), m.

        Raises
        ------
        ValueError : no line of the multisine, or a period that is too short for one, at this rate.
        """
        rest, count = np.zeros(round(REST * rate)), round(self.period * rate)
        if self.kind == "step":
            up = np.where(np.arange(count) < count // 2, self.size, 0.0)
            return np.concatenate([rest, np.tile(up, self.repeats), rest])
        lines = self.lines(rate)
        phase = -np.pi * lines * (lines - 1) / len(lines)  # Schroeder: a low peak
        wave = np.cos(2 * np.pi * np.outer(np.arange(count) / count, lines) + phase).sum(axis=1)
        return np.concatenate([rest, np.tile(self.size * wave / np.abs(wave).max(), self.repeats + 1), rest])

    def lines(self, rate: float) -> np.ndarray:
        """Return the lines of the multisine, shape (lines,), how many periods each has in one of the multisine's."""
        count = round(self.period * rate)
        most = min(int(self.highest * self.period + 1e-9), (count - 1) // 2)
        if most < 3:
            raise ValueError(f"highest is {self.highest:g} Hz, must be >= {3 / self.period:g} Hz: three bins")
        return np.arange(1, most + 1)


@dataclass(frozen=True)
class Response:
    """What was measured of a manipulator, and the model of first order with dead time that is nearest to it.

    Parameters
    ----------
    at : array, shape (points,), s from the beginning of a period, or Hz
    measured, modelled : arrays, shape (points,), 1
        Mean over the periods of the answer to steps of 1, or complex frequency response.
    spread : array, shape (points,), 1
        Standard error of what was measured.
    numbers, errors : arrays, shape (3,)
        Gain (1), time constant and dead time (s), with standard errors.
    noise : float, m
        Root mean square of what differs from one period to the next.
    """

    at: np.ndarray
    measured: np.ndarray
    modelled: np.ndarray
    spread: np.ndarray
    numbers: np.ndarray
    errors: np.ndarray
    noise: float

    def told(self, rate: float) -> dict[str, Any]:
        """Return it for JSON: each number with its error, the bandwidth, and the terms of `[midranging.pair]`."""
        gain, time, delay = self.numbers.tolist()
        pole = float(np.exp(-1.0 / (rate * time)))
        numbers = dict(zip(NUMBERS, self.numbers.tolist(), strict=True))
        errors = {f"{name}_error": value for name, value in zip(NUMBERS, self.errors.tolist(), strict=True)}
        left = float(np.linalg.norm(self.measured - self.modelled) / np.linalg.norm(self.measured))
        terms = {"outputs": [pole], "inputs": [gain * (1.0 - pole)], "delay_samples": delay * rate}
        found = {"bandwidth": 1.0 / (2.0 * np.pi * time), "noise": self.noise, "unexplained": left}
        return {**numbers, **errors, **found, "terms": terms}


def response(record: Recording, name: str, wanted: Wanted) -> Response | None:
    """Return the response of a manipulator from a recording; None where it was not excited for two periods.

    Parameters
    ----------
    record : Recording
        With `fast_reference`, `slow_reference`, `fast` and `slow`, m.
    name : str, one of `MANIPULATORS`
    wanted : Wanted
    """
    rate, whole = record.rate, wanted.excitation(record.rate)
    count, rest = round(wanted.period * rate), round(REST * rate)
    start = wanted.manipulators.index(name) * len(whole) + rest
    seen = record.select([MANIPULATORS[name]]).data[:, 0].astype(float)
    still = seen[start - rest : start].mean() if len(seen) > start else 0.0
    periods = seen[start : start + len(whole) - 2 * rest] - still
    periods = periods[: len(periods) // count * count].reshape(-1, count)
    if wanted.kind == "step":
        after = _steps(len(periods), count, rate)
        return _fitted(periods / wanted.size, np.arange(count) / rate, after, _times(1 / rate, wanted.period), wanted)
    asked, lines = np.fft.rfft(whole[rest : rest + count]), wanted.lines(rate)
    held = np.exp(1j * np.pi * lines / count)  # what is asked is held over a sample: half of one late
    each = held * (np.fft.rfft(periods[1:], axis=1) / asked)[:, lines] if len(periods) else periods
    at = lines / wanted.period
    times = _times(1 / (2 * np.pi * at[-1]), 1 / (2 * np.pi * at[0]))
    return _fitted(each, at, lambda numbers: _at_lines(numbers, at)[None], times, wanted, periods[1:])


Model = Callable[[np.ndarray], np.ndarray]
"""What numbers say of every period, shape (periods, points) or (1, points)."""


def _steps(periods: int, count: int, rate: float) -> Model:
    """Return what a model answers to steps of 1 from rest, up and down: a period begins where the last one ended."""
    time = np.arange(periods * count) / rate
    turns = [(number * count + half) / rate for number in range(periods) for half in (0, count // 2)]

    def answer(numbers: np.ndarray) -> np.ndarray:
        gain, constant, delay = numbers
        total = np.zeros(len(time))
        for number, turn in enumerate(turns):
            total += (-1) ** number * -np.expm1(-np.maximum(time - turn - delay, 0.0) / constant)
        return np.asarray(gain * total.reshape(periods, count))

    return answer


def _at_lines(numbers: np.ndarray, at: np.ndarray) -> np.ndarray:
    gain, constant, delay = numbers
    turn = 2j * np.pi * at
    return np.asarray(gain * np.exp(-turn * delay) / (1.0 + turn * constant))


def _times(shortest: float, longest: float) -> Iterator[np.ndarray]:
    """Give points to begin at: time constants that can be told, with and without dead time."""
    for constant in np.geomspace(shortest, longest, 5):
        for delay in (0.0, 0.25 * constant, constant):
            yield np.array([1.0, constant, delay])


def _fitted(
    each: np.ndarray,
    at: np.ndarray,
    model: Model,
    starts: Iterator[np.ndarray],
    wanted: Wanted,
    periods: np.ndarray | None = None,
) -> Response | None:
    """Fit a model to what each period shows, (periods, points), and to all without each in turn."""
    count = len(each)
    if count < 2:
        return None
    raw = wanted.size * each if periods is None else periods
    latest = LATEST * wanted.period
    numbers = _fit(each, model, np.ones(count, bool), starts, latest)
    without = np.array([_fit(each, model, np.arange(count) != out, iter([numbers]), latest) for out in range(count)])
    if not np.iscomplexobj(each):  # where rest is, all of it tells, and not the beginning alone
        each = each - (each - model(numbers)).mean()
    mean, modelled = each.mean(axis=0), np.broadcast_to(model(numbers), each.shape).mean(axis=0)
    differs = each - model(numbers) - (mean - modelled)
    return Response(
        at,
        mean,
        modelled,
        np.sqrt(np.sum(np.abs(differs) ** 2, axis=0) / (count * (count - 1))),
        numbers,
        np.sqrt((count - 1) / count * np.sum((without - without.mean(axis=0)) ** 2, axis=0)),
        float(np.sqrt(np.sum((raw[1:] - raw[1:].mean(axis=0)) ** 2) / max(1, raw[1:].size - raw.shape[1]))),
    )


def _fit(each: np.ndarray, model: Model, kept: np.ndarray, starts: Iterator[np.ndarray], latest: float) -> np.ndarray:
    def left(numbers: np.ndarray) -> np.ndarray:
        away = (model(numbers) - each)[kept].ravel()
        return np.concatenate([away.real, away.imag]) if np.iscomplexobj(away) else away - away.mean()

    bounds = ([-np.inf, 1e-6, 0.0], [np.inf, np.inf, latest])
    begun = (np.minimum(start, (np.inf, np.inf, 0.9 * latest)) for start in starts)
    ends = (least_squares(left, start, bounds=bounds, x_scale=np.maximum(np.abs(start), 1e-3)) for start in begun)
    found: np.ndarray = min(ends, key=lambda end: float(end.cost)).x
    return found


def figures(record: Recording, wanted: Wanted) -> dict[str, Any]:
    """Return what a run comes to: what was asked, and of each manipulator what `Response.told` says.

    Raises
    ------
    ValueError : no manipulator was excited for two periods.
    """
    found = {name: response(record, name, wanted) for name in wanted.manipulators}
    told = {name: each.told(record.rate) for name, each in found.items() if each is not None}
    if not told:
        raise ValueError("nothing can be read off: no manipulator was excited for two periods")
    return {"asked": wanted.model_dump(), **told}

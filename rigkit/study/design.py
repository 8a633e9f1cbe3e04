"""The cases of a study's settings: every combination, a Latin hypercube, or a list as it stands."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from scipy.stats import qmc

from rigkit.config import ConfigError, Section, setting
from rigkit.config_fault import shown
from rigkit.study.file import Settings, part
from rigkit.toml_text import key_text

DIGITS = 6
"""Significant ones of a number that a hypercube draws: a command line stays legible, and repeats it exactly."""

Case = dict[str, Any]


class Range(Section):
    """What a hypercube draws a number from, evenly."""

    low: float = setting(0.0, "", "the lower end")
    high: float = setting(1.0, "", "the upper end")
    log: bool = setting(False, "", "even in the logarithm")
    whole: bool = setting(False, "", "whole numbers, both ends among them")


def cases(settings: Settings) -> list[Case]:
    """Return the cases, each as values by key; one without any where nothing is set.

    Raises
    ------
    ConfigError : the text names the key and what is wrong with it.
    """
    if settings.method == "list":
        return _listed(settings)
    if settings.cases:
        raise ConfigError(f'settings.cases is given, but settings.method is "{settings.method}"')
    axes = {key: _axis(key, values, settings.method) for key, values in settings.values.items()}
    if settings.method == "grid":
        return [dict(zip(axes, combined, strict=True)) for combined in product(*axes.values())]
    if not axes:
        raise ConfigError("settings.values is {}, must hold at least one key for a hypercube")
    cube = qmc.LatinHypercube(len(axes), seed=np.random.default_rng(settings.seed)).random(settings.points)
    return [dict(zip(axes, _drawn(axes.values(), point), strict=True)) for point in cube]


def _listed(settings: Settings) -> list[Case]:
    if settings.values:
        raise ConfigError('settings.values is given, but settings.method is "list"')
    if not settings.cases:
        raise ConfigError("settings.cases is [], must hold at least one case")
    keys = {tuple(sorted(case)) for case in settings.cases}
    if len(keys) > 1:
        raise ConfigError("settings.cases: all must have the same keys")
    return [dict(case) for case in settings.cases]


def _axis(key: str, values: Any, method: str) -> Sequence[Any] | Range:
    where = f"settings.values.{key_text(key)}"
    if isinstance(values, list) and values:
        return values
    if isinstance(values, Mapping) and method == "latin":
        made = part(Range, values, where, "a range")
        if not made.low < made.high or (made.log and made.low <= 0):
            raise ConfigError(f"{where} is {shown(values)}, must have low < high, and low > 0 with log")
        return made
    wanted = "a list of values" if method == "grid" else "a list of values, or a table of low and high"
    raise ConfigError(f"{where} is {shown(values)}, must be {wanted}")


def _drawn(axes: Any, point: np.ndarray) -> Iterator[Any]:
    for axis, share in zip(axes, point.tolist(), strict=True):
        if not isinstance(axis, Range):
            yield axis[int(share * len(axis))]
        elif axis.whole:
            yield int(np.floor(_between(axis.low, axis.high + 1, share, axis.log)))
        else:
            yield float(f"{_between(axis.low, axis.high, share, axis.log):.{DIGITS}g}")


def _between(low: float, high: float, share: float, is_log: bool) -> float:
    return float(low * (high / low) ** share) if is_log else low + (high - low) * share

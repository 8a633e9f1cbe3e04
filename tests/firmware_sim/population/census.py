"""What tests of every kind of machine look at: numbers of many draws, and a checksum of them."""

import hashlib
from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np

from firmware_sim.population.draw import Draw, Population

SEEDS = range(300)


@cache
def all_draws(population: Population, number: int = len(SEEDS)) -> list[Draw]:
    """Draw the machines of the first `number` of `SEEDS`, once."""
    return [population.draw(seed) for seed in SEEDS[:number]]


def numbers(draws: Iterable[Draw], name: str) -> np.ndarray:
    """Return all numbers that draws have of a quantity, shape (numbers,); words are left out."""
    found: list[float] = []
    for draw in draws:
        values = [each.value for each in draw.quantities if each.name == name]
        for value in values:
            found += [float(each) for each in (value if isinstance(value, tuple) else (value,)) if not _is_word(each)]
    return np.array(found)


def words(draws: Iterable[Draw], name: str) -> set[str]:
    """Return the words that draws have of a quantity."""
    return {each.value for draw in draws for each in draw.quantities if each.name == name and _is_word(each.value)}


def fills(found: np.ndarray, low: float, high: float, reach: float = 0.1) -> bool:
    """Whether numbers lie in a range, and come within `reach` of its width, in logarithms, of both its ends."""
    part = np.log(found / low) / np.log(high / low)
    return bool(part.min() >= -1e-9 and part.max() <= 1 + 1e-9 and part.min() < reach and part.max() > 1 - reach)


def checksum(draws: Iterable[Draw]) -> str:
    """Return a hash of all that was drawn and of the keys, numbers to six digits: the same wherever it is made."""
    whole = hashlib.sha256()
    for draw in draws:
        for each in draw.quantities:
            whole.update(f"{each.name} {_text(each.value)} {each.unit}\n".encode())
        for key, value in draw.keys.items():
            whole.update(f"{key} {_text(value)}\n".encode())
    return whole.hexdigest()[:16]


def _is_word(value: object) -> bool:
    return isinstance(value, str)


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ",".join(f"{key}={_text(each)}" for key, each in sorted(value.items()))
    if isinstance(value, tuple | list):
        return ",".join(_text(each) for each in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)

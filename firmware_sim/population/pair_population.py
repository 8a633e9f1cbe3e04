"""What a draw of a pair says of it, and the keys of the cell's file that fit it."""

from math import ceil, exp
from typing import Any

import numpy as np

from firmware_sim.population.draw import Draw, Population, Quantity
from firmware_sim.population.pairs import FAMILIES, KIND, RATE, DrawnPair, draw_pair

PLANT = "firmware_sim.population:Pair"
FAINTEST = 1e-7
"""m, of noise that is told: there is always some."""
WAVE = 0.5e-3
"""m, of the estimation's waves, where nothing limits them."""


def _keys(drawn: DrawnPair, seed: int, family: str) -> dict[str, Any]:
    """Return what a user knows: both loops by their step responses, the limits, the noise, and waves that fit."""
    micro, table = drawn.plant.micro, dict[str, Any]()
    poles = [_rounded(exp(-1.0 / (time * RATE))) for time in (drawn.fast, drawn.slow)]
    lead = micro.limit / micro.inner_gain
    half = float(np.clip(ceil(4.0 * drawn.slow) / 2.0, 0.5, 5.0))
    table |= {f"pair.{name}_outputs": (pole,) for name, pole in zip(("fast", "slow"), poles, strict=True)}
    table |= {
        f"pair.{name}_inputs": (_rounded(1.0 - pole),) for name, pole in zip(("fast", "slow"), poles, strict=True)
    }
    table |= {
        "pair.travel": _rounded(drawn.travel),
        "inner.numerator": (_rounded(micro.inner_gain),),
        "inner.limit": _rounded(micro.limit),
        "learning.noise": _rounded(max(drawn.plant.noise[0], FAINTEST)),
        "estimating.fast_amplitude": _rounded(min(WAVE, 0.4 * lead, 0.4 * drawn.travel)),
        "estimating.slow_amplitude": WAVE,
        "estimating.fast_half_period": float(np.clip(ceil(40.0 * drawn.fast) / 10.0, 0.2, 2.0)),
        "estimating.slow_half_period": half,
        "session.lead": max(14.0, 8.0 * half),
        "simulator.plant": PLANT,
        "simulator.options": {"seed": seed, "family": family},
    }
    return {"rig.name": f"pair-{seed}", **{f"midranging.{key}": value for key, value in table.items()}}


def _rounded(value: float) -> float:
    """Return a number as a person notes it."""
    return float(f"{value:.4g}")


def _quantities(drawn: DrawnPair) -> tuple[Quantity, ...]:
    macro, micro = drawn.plant.macro, drawn.plant.micro
    return (
        Quantity("order of macro", len(macro.poles)),
        Quantity("time to 63 %, macro, micro", (drawn.slow, drawn.fast), "s"),
        Quantity("dead time", 1e3 * macro.dead_time, "ms"),
        Quantity("filter of guided motion", macro.corner, "Hz"),
        Quantity("its order", macro.filters),
        Quantity("fastest", 1e3 * macro.speed, "mm/s"),
        Quantity("mode of macro", macro.mode if macro.share else "none", "Hz"),
        Quantity("its damping", 100 * macro.damping if macro.share else "none", "%"),
        Quantity("its share", macro.share, "1"),
        Quantity("travel", 1e3 * drawn.travel, "mm"),
        Quantity("inner gain", micro.inner_gain, "1/s"),
        Quantity("inner limit", 1e3 * micro.limit, "mm/s"),
        Quantity("lag of micro", 1e3 * micro.lag, "ms"),
        Quantity("mode of micro", micro.mode, "Hz"),
        Quantity("share of that", micro.share, "1"),
        Quantity("noise of relative, fast, slow", tuple(1e6 * each for each in drawn.plant.noise), "um"),
    )


def _make(family: str, seed: int) -> Draw:
    drawn = draw_pair(seed, family)
    return Draw(KIND, family, seed, _quantities(drawn), _keys(drawn, seed, family))


PAIRS = Population(KIND, FAMILIES, _make)
"""Macro and micro manipulators."""

"""The kinds of machine that can be drawn, by name."""

from firmware_sim.population.draw import Population
from rigkit.code_name import resolve

KINDS: dict[str, str] = {
    "cell": "firmware_sim.population.cell_population:CELLS",
    "pair": "firmware_sim.population.pair_population:PAIRS",
    "signal": "firmware_sim.population.signal_population:SIGNALS",
    "stage": "firmware_sim.population.stage_population:STAGES",
    "vibrator": "firmware_sim.population.vibrators:VIBRATORS",
}
"""Kind -> "module:NAME" of its `Population`, imported when it is asked for."""


def population(kind: str) -> Population:
    """Return a kind of machine.

    Raises
    ------
    ValueError : there is none of that name.
    """
    if kind not in KINDS:
        raise ValueError(f"KIND is {kind!r}, must be {', '.join(KINDS)}")
    found: Population = resolve(KINDS[kind])
    return found

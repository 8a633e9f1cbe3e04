"""What a stack does with its voltage, as numbers: stroke, curvature, loops that widen with rate, creep."""

import numpy as np

VOLTAGE = 1000.0
"""V, the amplifier gives 0 to this."""
AMPLIFIER_CORNER = 900.0
"""Hz, into the stack's capacitance."""
AMPLIFIER_SLEW = 2e5
"""V/s: 0.2 A into 1 uF."""
STROKES = (97e-6, 98e-6, 102e-6)
"""m, free, over the whole voltage, x y z."""
STROKE_SPREAD = 0.015
"""Relative standard deviation, cut off at two of it."""
CURVATURE = (0.02, 0.08)
"""1: by how much of the stroke, times 4 u (1 - u), the polarization saturates over the range u = 0 ... 1."""

PLAYS = 10
WIDEST_PLAY = 0.42
"""1, of the range: the threshold beyond which no domain walls are pinned."""
OPENING = (0.150, 0.210)
"""1, of the span: the quasi-static loop over the whole range, without creep.

Sources: 10 to 15 % [PI Ceramic, Piezo tutorial, "Hysteresis"]; 15 to 23 % of span in records of stacks, of which the
creep and the lag below make their part (23.0 % at 1 Hz on the PICMA stack of Aye and Ang, ICSTSD 2018).
"""
PINNING_DECAY = (0.0, 1.0)
"""1: density of the plays over their thresholds, exp(-decay r / widest); about uniform is Rayleigh's law."""
PLAY_LAG = (0.2e-3, 1.5e-3)
"""s: time in which a wall that is free to move does; makes the loops wider as they run faster."""

CREEP_TIMES = (0.02, 0.2, 2.0, 20.0, 200.0, 2000.0)
"""s: one slow first-order term a decade."""
CREEP_A_DECADE = (0.011, 0.019)
"""1: 0.01 to 0.02 [PI Ceramic, Piezo tutorial, "Creep"].  Half a stroke then creeps by 0.02 um/s after 16 s."""

CONSTANTS = 5
COLUMNS = CONSTANTS + 3 * PLAYS + 2 * len(CREEP_TIMES)


def draw_actuators(rng: np.random.Generator, rate: float, hysteresis: float, creep: float) -> np.ndarray:
    """Draw three stacks.

    Parameters
    ----------
    rng : Generator
    rate : float, samples/s
    hysteresis, creep : float, 1
        Scale the loops and the creep.

    Returns
    -------
    array, shape (3, COLUMNS)
        For each: stroke (m), curvature, the linear share, the amplifier's pole and slew (V a sample); then thresholds
        (of the range), weights and moves a sample of the plays; then poles and weights of the creep.
    """
    table = np.zeros((3, COLUMNS))
    threshold = WIDEST_PLAY * (np.arange(PLAYS) + 0.5) / PLAYS
    for axis, row in enumerate(table):
        stroke = STROKES[axis] * (1 + STROKE_SPREAD * np.clip(rng.standard_normal(), -2, 2))
        curvature, opening = rng.uniform(*CURVATURE), hysteresis * rng.uniform(*OPENING)
        density = np.exp(-rng.uniform(*PINNING_DECAY) * threshold / WIDEST_PLAY)
        density /= density.sum()
        lost = 2 * density @ threshold  # of the plays' travel over the whole range
        gap = 2 * density @ np.minimum(threshold, 0.5 - threshold)  # between their branches at mid-range
        share = opening / (gap + opening * lost)
        lag = np.geomspace(*PLAY_LAG, PLAYS)[rng.permutation(PLAYS)]
        grown = creep * rng.uniform(*CREEP_A_DECADE)
        row[:CONSTANTS] = (
            stroke / (1 - share * lost),
            curvature,
            1 - share,
            np.exp(-2 * np.pi * AMPLIFIER_CORNER / rate),
            AMPLIFIER_SLEW / rate,
        )
        row[CONSTANTS : CONSTANTS + 3 * PLAYS] = np.concatenate(
            [threshold, share * density, -np.expm1(-1 / (rate * lag))]
        )
        times = np.array(CREEP_TIMES)
        row[CONSTANTS + 3 * PLAYS :] = np.concatenate([np.exp(-1 / (rate * times)), np.full(len(times), grown)])
    return table

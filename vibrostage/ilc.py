"""Iterative learning control on plain arrays: the programs' own laws, and those they are measured against.

Frequency domain: `KalmanILC`, `ThesisILC`.  Linear laws of either domain: `LinearILC`, made by `norm_optimal`, `p_type`
and `with_low_pass`; `lifted` gives a plant's matrix over a trial, `convergence` what becomes of a law on a plant.

Examples
--------
A drive for a measured response, from trial to trial::

    law = KalmanILC(response, variance, reference)
    for _ in range(20):
        measured = emit(law.drive)          # your own: play it, return the spectrum of what came
        law.step(law.drive, measured, noise=power)

In lifted form::

    plant = lifted(impulse_response, samples)
    law = norm_optimal(plant, change=0.1)
    drive = law.step(drive, reference - measured)
    convergence(law, plant).is_monotone
"""

from vibractl.learning.linear_law import (
    Convergence,
    LinearILC,
    convergence,
    lifted,
    norm_optimal,
    p_type,
    with_low_pass,
)
from vibractl.learning.of_arrays import FrequencyDomainILC, KalmanILC, ThesisILC

__all__ = [
    "Convergence",
    "FrequencyDomainILC",
    "KalmanILC",
    "LinearILC",
    "ThesisILC",
    "convergence",
    "lifted",
    "norm_optimal",
    "p_type",
    "with_low_pass",
]

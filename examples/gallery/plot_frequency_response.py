"""
Modes of a measured frequency response
======================================

A measured response with its variance, for example from a multisine, gives a state-space model and its modes with
standard errors.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import sysid

random = np.random.default_rng(2)
frequency = np.linspace(5.0, 200.0, 400)
s = 2j * np.pi * frequency


def mode(own: float, damping: float, size: float) -> np.ndarray:
    """Return a mode's acceleration over its force."""
    w = 2 * np.pi * own
    return size * s**2 / (s**2 + 2 * damping * w * s + w**2)


true = mode(24.0, 0.04, 1.0) + mode(66.0, 0.02, 0.7) - mode(120.0, 0.03, 0.5)
spread = 0.01 * np.abs(true).max()
noise = spread * np.sqrt(0.5) * (random.standard_normal(400) + 1j * random.standard_normal(400))
found = sysid.identify_response(frequency, true + noise, np.full(400, spread**2))

figure, axes = plt.subplots(layout="constrained")
axes.semilogy(frequency, np.abs(true + noise), ".", markersize=3, label="measured")
axes.semilogy(frequency, np.abs(found.response(frequency)).ravel(), label=f"model of order {found.order}")
axes.set(xlabel="frequency, Hz", ylabel="|G|")
axes.legend()
plt.show()

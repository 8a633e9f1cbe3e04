"""
Robustness by a low-pass filter
===============================

Above 120 Hz the model has the wrong sign.  A law that inverts it at all frequencies diverges there; with a zero-phase
low-pass it converges, and the error above the cutoff remains.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import ilc

frequency = np.arange(1.0, 200.0)
plant = (np.exp(-0.01j * frequency) / (1 + 0.02j * frequency))[:, None, None]
model = np.where(frequency > 120, -1.0, 1.0)[:, None, None] * plant

figure, axes = plt.subplots(layout="constrained")
for law, name in (
    (ilc.LinearILC(0.5 / model), "inverse"),
    (ilc.with_low_pass(0.5 / model, frequency, lambda f: 1 / (1 + (f / 90) ** 12)), "inverse and low-pass"),
):
    found = ilc.convergence(law, plant)
    axes.plot(frequency, found.radius, label=f"{name}: {'converges' if found.converges else 'does not converge'}")
axes.axhline(1.0, color="k", linewidth=0.8)
axes.set(xlabel="frequency, Hz", ylabel="factor from trial to trial")
axes.legend()
plt.show()

"""
Learning a drive with a wrong model
===================================

The model lacks a resonance, and its phase is off by 70 degrees.  The Kalman law estimates the plant along with the
drive; a law with the fixed model hardly learns, and its error grows where the resonance shifts the phase further.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import ilc

frequency = np.arange(1.0, 200.0)
plant = np.exp(-0.01j * frequency) / (1 + 0.02j * frequency) * (1 + 0.5 / (1 + 1j * (frequency - 80) / 6))
model = np.exp(1.2j - 0.01j * frequency) / (1 + 0.02j * frequency)
wanted = np.exp(-0.5 * ((frequency - 70) / 20) ** 2)

# %%
# In each trial: emit the drive, measure the response, compute the next drive.

law = ilc.KalmanILC(model, 1.5 * np.abs(model) ** 2, wanted, frequency=frequency)
fixed = ilc.LinearILC((0.3 / model)[:, None, None])
drive = (wanted / model)[:, None]
errors = []
for _ in range(25):
    errors.append([np.abs(wanted - plant * law.drive).max(), np.abs(wanted - plant * drive[:, 0]).max()])
    law.step(law.drive, plant * law.drive)
    drive = fixed.step(drive, (wanted - plant * drive[:, 0])[:, None])

figure, axes = plt.subplots(layout="constrained")
axes.semilogy(errors, label=["KalmanILC", "the model kept, gain 0.3"])
axes.set(xlabel="trial", ylabel="largest error of a bin, re the reference")
axes.legend()

# %%
# What it believes of the plant now, where the drive has moved enough to show it.

figure, axes = plt.subplots(layout="constrained")
axes.plot(frequency, np.abs(plant), label="plant")
axes.plot(frequency, np.abs(model), "--", label="model")
axes.plot(frequency, np.abs(law.response), label="believed after 25 trials")
axes.set(xlabel="frequency, Hz", ylabel="|G|")
axes.legend()
plt.show()

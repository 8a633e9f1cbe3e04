"""
The weights of a norm-optimal law
=================================

In lifted form a trial is a vector, the plant a triangular matrix.  The weight of the change sets the speed of
convergence, that of the drive the remaining error.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import ilc

samples = 100
plant = ilc.lifted(np.r_[0.0, 0.5 * 0.8 ** np.arange(samples - 1)], samples)
reference = np.sin(np.arange(samples) / 6.0)

figure, axes = plt.subplots(layout="constrained")
for drive_weight, change in ((0.0, 0.1), (0.0, 1.0), (1e-3, 0.1)):
    law = ilc.norm_optimal(plant, drive=drive_weight, change=change)
    drive, errors = np.zeros(samples), []
    for _ in range(30):
        error = reference - plant @ drive
        errors.append(np.linalg.norm(error[1:]))
        drive = law.step(drive, error)
    left = np.linalg.norm((ilc.convergence(law, plant).left @ reference)[1:])
    axes.semilogy(errors, label=f"R = {drive_weight:g}, S = {change:g}: {left:.1e} is left")
axes.set(xlabel="trial", ylabel="|| e ||")
axes.legend()
plt.show()

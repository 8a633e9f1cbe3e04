"""
Convergence after a transient growth
====================================

All eigenvalues of a P-type law equal that of the plant's first sample, so it converges asymptotically.  Whether the
error decreases in each trial depends on the largest singular value, which can be computed beforehand.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import ilc

samples = 60
time = np.arange(samples)
ringing = np.where(time > 0, np.cos(0.6 * (time - 1.0)) * 0.95 ** (time - 1.0), 0.0)
plant = ilc.lifted(ringing, samples)
reference = np.sin(time / 6.0)

figure, axes = plt.subplots(layout="constrained")
for law, name in (
    (ilc.p_type(0.5, samples), "P-type"),
    (ilc.norm_optimal(plant, change=1.0), "norm-optimal"),
):
    drive, errors = np.zeros(samples), []
    for _ in range(60):
        error = reference - plant @ drive
        errors.append(np.linalg.norm(error[1:]))
        drive = law.step(drive, error)
    axes.semilogy(errors, label=f"{name}: largest singular value {ilc.convergence(law, plant).norm:.3g}")
axes.set(xlabel="trial", ylabel="|| e ||")
axes.legend()
plt.show()

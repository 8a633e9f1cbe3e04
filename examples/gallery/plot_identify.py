"""
A model from a record
=====================

One call gives the order, poles with their errors, and fits on validation data.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import dlsim, zpk2ss

from vibrostage import sysid

random = np.random.default_rng(1)
poles = [0.95 * np.exp(0.4j), 0.95 * np.exp(-0.4j), 0.6]
system = (*zpk2ss([0.2], poles, 0.1), 1.0)
u = random.standard_normal((4000, 1))
y = dlsim(system, u)[1] + 0.05 * random.standard_normal((4000, 1))

found = sysid.identify(u[:3000], y[:3000], rate=100.0)
print(found.summary())

# %%
# On validation data:

record = slice(3000, 3200)
figure, axes = plt.subplots(layout="constrained")
axes.plot(y[record], label="measured")
axes.plot(found.model.simulate(u[record]), label="free run of the model, from rest")
axes.set(xlabel="sample", ylabel="y")
axes.legend()
plt.show()

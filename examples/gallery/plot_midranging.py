"""
Mid-ranging beside python-control
=================================

The fast actuator responds first, the slow one takes over, and the fast one returns to mid-range.  Without saturation
modified valve position control is a linear loop: python-control's simulation of it, built here from the
tuning rule, is drawn as well where that package is installed (``pip install 'vibrostage[control]'``).
"""

import matplotlib.pyplot as plt
import numpy as np

from vibrostage import midranging

rate = 100.0
poles = {"fast": 0.9, "slow": 0.99}
fast, slow = (([1.0 - pole], [1.0, -pole]) for pole in poles.values())
reference = np.repeat([0.0, 1.0], [100, 900])

mvpc = midranging.valve_position(fast, slow, rate)
linear = midranging.simulate(mvpc, fast, slow, reference)

# %%
# The same with a saturated control signal, and a dead time of 0.1 s unknown to both controllers.

late = (slow[0], slow[1] + [0.0] * 10)
inner, limit = (5.0,), 2.0
anti_windup = midranging.valve_position(fast, slow, rate, "mvpc-aw", inner=inner, limit=limit)
adaptive = midranging.adaptive(fast, slow, rate, wave=0.1, noise=1e-4, inner=inner, limit=limit, travel=2.0)
runs = {
    name: midranging.simulate(controller, fast, late, reference, noise=1e-4)
    for name, controller in (("mvpc-aw", anti_windup), ("adaptive", adaptive))
}

figure, (upper, lower) = plt.subplots(2, 1, sharex=True, layout="constrained")
upper.plot(linear.time, linear.position, label="position, MVPC")
upper.plot(linear.time, linear.fast, label="fast")
upper.plot(linear.time, linear.slow, label="slow")
for name, run in runs.items():
    lower.plot(run.time, run.position, label=f"{name}, IAE {run.iae:.3f}")
upper.set(ylabel="position and drives")
lower.set(xlabel="time, s", ylabel="position")

try:
    import control
except ImportError:
    print("python-control is not installed: nothing is laid over the loop")
else:
    z = control.tf([1, 0], [1], 1.0 / rate)
    pi_fast, pi_slow = (1 - np.log(pole) / (z - 1) for pole in poles.values())  # lambda is the time constant
    process_fast, process_slow = ((1 - pole) / (z - pole) for pole in poles.values())
    opened = pi_fast * (process_fast + process_slow * pi_slow)
    peer = control.forced_response(control.feedback(opened), linear.time, reference).outputs
    upper.plot(linear.time, peer, "k--", linewidth=1.0, label="python-control")
    print(f"largest difference from python-control: {np.abs(peer - linear.position).max():.1e}")

upper.legend()
lower.legend()
plt.show()

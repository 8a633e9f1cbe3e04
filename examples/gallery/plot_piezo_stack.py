"""
The simulated piezo stage without control
=========================================

A triangular voltage on one axis: hysteresis loops that depend on the reversal points, and creep after the last
reversal.  `stagectl run` controls this stage to a micrometre.  A block is called like in a graph, with a frame of
each of its ports.
"""

import matplotlib.pyplot as plt
import numpy as np

from firmware_sim.stage_blocks import PiezoStage

rate, seconds = 10_000.0, 4.0
time = np.arange(round(rate * seconds)) / rate
voltage = np.full((len(time), 3), 500.0)
voltage[:, 0] += 400 * np.interp(time, [0, 0.5, 1.0, 1.5, 2.0, 2.25, 4.0], [0, 1, -1, 0.5, -0.5, 0.4, 0.4])

stage = PiezoStage(seed=1)
stage.prepare(rate, len(time))
nothing = np.zeros_like(voltage)
extension, position, absolute = (np.zeros_like(voltage) for _ in range(3))
stage.process(voltage, nothing, nothing, extension, position, absolute)

settled = time > 0.25
figure, (loop, creep) = plt.subplots(1, 2, layout="constrained", figsize=(9, 4))
loop.plot(voltage[settled, 0], 1e6 * position[settled, 0], linewidth=0.8)
loop.set(xlabel="voltage, V", ylabel="position of the plate, um")
late = time > 2.3
creep.plot(time[late] - 2.25, 1e6 * (position[late, 0] - position[late, 0][0]), linewidth=0.5)
creep.set(xlabel="time after the last turn, s", ylabel="creep, um")
plt.show()

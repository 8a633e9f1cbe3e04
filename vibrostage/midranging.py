"""Mid-ranging of a fast and a slow actuator on plain arrays: valve position and adaptive internal model control.

`valve_position` (VPC, MVPC, with or without anti-windup) and `adaptive` design a `Controller` from two discrete closed
loops, transfer functions or state spaces, in any unit of length; `Controller.step` is for a loop of your own,
`simulate` runs it against loops that may be others than it was designed from.

Examples
--------
>>> import numpy as np
>>> rate = 100.0
>>> fast, slow = ([0.1], [1.0, -0.9]), ([0.01], [1.0, -0.99])
>>> run = simulate(valve_position(fast, slow, rate), fast, slow, np.ones(1500))
>>> bool(abs(run.position[-1] - 1.0) < 1e-3), bool(abs(run.fast[-1]) < 1e-3)
(True, True)
"""

from stagectl.robot.midranging.array_loop import as_model
from stagectl.robot.midranging.array_run import Run, simulate
from stagectl.robot.midranging.design import ValveFactors
from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.of_arrays import Asked, Controller, adaptive, valve_position

__all__ = [
    "Asked",
    "Controller",
    "Estimation",
    "Run",
    "ValveFactors",
    "adaptive",
    "as_model",
    "simulate",
    "valve_position",
]

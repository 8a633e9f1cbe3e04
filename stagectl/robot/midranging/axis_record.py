"""One axis' numbers as packed records: settings and memory of its estimators, models, governor and PI controllers."""

import numpy as np

ORDER = 3
"""Highest of a model."""
SIZE = 2 * ORDER
ESTIMATING, ACTIVE = range(2)
"""Of `phase`."""

VALVE = np.dtype(
    [
        ("fast_gain", "f8"),
        ("fast_rate", "f8"),  # 1 a sample
        ("slow_gain", "f8"),
        ("slow_rate", "f8"),
        ("tracking", "f8"),  # 1 a sample
        ("limit", "f8"),  # m/s
        ("inner_gain", "f8"),  # 1/s
        ("middle", "f8"),  # m
        ("feed", "f8"),
        ("pole", "f8"),
        # memory, m
        ("fast_integral", "f8"),
        ("slow_integral", "f8"),
        ("slow_model", "f8"),
        ("fast", "f8"),  # the last references
        ("slow", "f8"),
        ("blind", "i8"),  # samples in which an input was no number
    ],
    align=True,
)
"""Valve position control of one axis."""

SQUARES = np.dtype(
    [
        ("forgetting", "f8"),  # per update
        ("pole", "f8"),  # of the low-pass
        ("variance", "f8"),  # m^2, of the residual
        ("start", "f8"),  # of the covariance
        ("gate", "f8"),  # m
        ("drift", "f8"),
        ("limit", "f8"),
        # memory; covariance over the residual's variance: U above the diagonal and D on it; latest first
        ("estimate", "f8", SIZE),
        ("factors", "f8", (SIZE, SIZE)),
        ("outputs", "f8", ORDER),
        ("inputs", "f8", ORDER),
        ("slow_input", "f8"),
        ("alarm", "f8"),
        ("resets", "i8"),
        ("updates", "i8"),
        # for the time of an update: U' times regressors, covariance times regressors
        ("turned", "f8", SIZE),
        ("direction", "f8", SIZE),
    ],
    align=True,
)
"""Recursive least squares of one loop."""

RESPONSE = np.dtype([("used", "f8", SIZE), ("outputs", "f8", ORDER), ("inputs", "f8", ORDER)], align=True)
"""A desired response: parameters in use, past outputs and inputs, latest first."""

LOOP = np.dtype(
    [
        ("squares", SQUARES),
        ("wanted", RESPONSE),
        # excitation of the estimation phase, and how its end is judged
        ("amplitude", "f8"),  # m
        ("half_period", "f8"),  # samples
        ("noise", "f8"),  # m^2
        # the model in use; past outputs and inputs of it and of its inverse, latest first
        ("used", "f8", SIZE),
        ("mirrored", "f8", ORDER),
        ("outputs", "f8", ORDER),
        ("inputs", "f8", ORDER),
        ("inverse_outputs", "f8", ORDER),
        ("inverse_inputs", "f8", ORDER),
        ("error_power", "f8"),  # m^2
        ("output_power", "f8"),
        ("refused", "i8"),  # estimates that were not used
    ],
    align=True,
)
"""One manipulator's loop: its estimator, its model in use, and the desired response."""

GOVERNOR = np.dtype(
    [
        ("numerator", "f8", ORDER + 1),  # of the inner controller (3.6)
        ("denominator", "f8", ORDER + 1),
        ("limit", "f8"),  # m/s
        ("travel", "f8"),  # m, to either side of the middle
        ("horizon", "i8"),  # samples
        # memory, latest first: past errors (m) and signals (m/s) of the inner controller, positions (m)
        ("errors", "f8", ORDER),
        ("controls", "f8", ORDER),
        ("positions", "f8", ORDER),
        ("share", "f8"),
        ("control", "f8"),
    ],
    align=True,
)
"""The governor of one axis."""

AXIS = np.dtype(
    [
        ("fast", LOOP),
        ("slow", LOOP),
        ("governor", GOVERNOR),
        ("order", "i8"),
        ("middle", "f8"),  # m
        ("least_samples", "i8"),
        ("accuracy", "f8"),  # squared
        ("forget", "f8"),
        # memory
        ("phase", "i8"),
        ("count", "i8"),
        ("reference", "f8"),  # m, the last that was a number
        ("disturbance", "f8"),  # m
        ("blind", "i8"),  # samples in which something was no number
    ],
    align=True,
)
"""Adaptive internal model control of one axis."""

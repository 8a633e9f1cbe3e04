"""One axis' numbers as packed records: settings and memory of its estimators, models, governor and PI controllers."""

import numpy as np

ORDER = 3
"""Highest of a model."""
SIZE = 2 * ORDER
LINE = 512
"""Samples that a dead time is shorter than."""
BANK = 24
"""Dead times that are tried at once."""
ESTIMATING, ACTIVE, TAKEN_OVER = range(3)
"""Of `phase`: valve position control takes over in the last one."""
NO_REASON, INACCURATE, DIVERGING, OSCILLATING = range(4)
"""Of `reason`, why it did."""

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
        ("relative", "f8"),  # residual that the model's form leaves, squared, over the input's activity
        ("usual", "f8"),  # a residual squared over what is expected, beyond which a sample is left out
        ("keep", "f8"),  # per update, of the mean squares below
        # memory; covariance over the residual's variance: U above the diagonal and D on it; latest first
        ("estimate", "f8", SIZE),
        ("factors", "f8", (SIZE, SIZE)),
        ("outputs", "f8", ORDER),
        ("inputs", "f8", ORDER),
        ("slow_input", "f8"),
        ("activity", "f8"),  # m^2, of the smoothed input about its own mean
        ("residual_power", "f8"),  # m^2
        ("activity_power", "f8"),  # m^2
        ("alarm", "f8"),
        ("most", "f8"),  # that `relative` comes to where the alarm rings again and again
        ("calm", "i8"),  # updates since the alarm rang last
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
"""A response: parameters in use, past outputs and inputs, latest first."""

CANDIDATE = np.dtype(
    [("squares", SQUARES), ("model", RESPONSE), ("delay", "i8"), ("error_power", "f8")],  # samples, m^2
    align=True,
)
"""A model with one of the dead times that are tried."""

LOOP = np.dtype(
    [
        ("squares", SQUARES),
        ("wanted", RESPONSE),
        ("wanted_time", "f8"),  # samples, its time constant; 0 where it is not of first order
        ("bank", CANDIDATE, BANK),
        ("candidates", "i8"),
        ("chosen", "i8"),  # of them
        # excitation of the estimation phase, and how its end is judged
        ("amplitude", "f8"),  # m
        ("half_period", "f8"),  # samples
        ("noise", "f8"),  # m^2
        # the model in use, ahead of its dead time; past outputs and inputs of it and of its inverse, latest first
        ("used", "f8", SIZE),
        ("mirrored", "f8", ORDER),
        ("outputs", "f8", ORDER),
        ("inputs", "f8", ORDER),
        ("inverse_outputs", "f8", ORDER),
        ("inverse_inputs", "f8", ORDER),
        ("delay", "i8"),  # samples
        ("at", "i8"),  # where the lines are written
        ("inputs_line", "f8", LINE),
        ("outputs_line", "f8", LINE),
        ("off", "f8"),  # the model's error over its output as control begins, rms
        ("time", "f8"),  # samples, of the loop
        ("error_mean", "f8"),  # m
        ("error_power", "f8"),  # m^2
        ("output_mean", "f8"),  # m
        ("output_power", "f8"),
        ("window_pole", "f8"),  # of the watch over the model
        ("suspicion", "i8"),  # samples in which it was too far off
        ("refused", "i8"),  # estimates that were not used
        # robustness filter of what the model does not explain
        ("filter_pole", "f8"),
        ("filtered", "f8"),  # m
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
        ("margin", "f8"),  # m, for the noise of the position
        ("lean", "f8"),  # m, furthest that the position is taken to be from what is measured
        ("trust", "f8"),  # share of the limit that is used
        ("offset", "f8"),  # m, of the position from the model's, smoothed
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

SWING = np.dtype(
    [
        ("pole", "f8"),  # of the running mean
        ("least", "f8"),  # m, mean size that a half wave counts from
        ("noise", "f8"),  # m
        # memory
        ("mean", "f8"),  # m, of the error
        ("area", "f8"),  # m samples, of this half wave
        ("lowest", "f8"),  # m, of what is called for within it
        ("highest", "f8"),
        ("samples", "i8"),
        ("before", "i8"),  # samples of the half wave before
        ("sign", "f8"),
        ("envelope", "f8"),  # m
        ("count", "i8"),  # half waves of an oscillation
        ("halved", "i8"),  # times that valve position control's gain was, for its own oscillation
    ],
    align=True,
)
"""Half waves of one axis' error, between its zero crossings."""

AXIS = np.dtype(
    [
        ("fast", LOOP),
        ("slow", LOOP),
        ("governor", GOVERNOR),
        ("valve", VALVE),
        ("swing", SWING),  # what valve position control takes over for
        ("ripple", SWING),  # what only noise is smaller than, about a quicker mean
        ("tracking", "f8"),  # 1 a sample, of the valve position control's fast integral
        ("order", "i8"),
        ("middle", "f8"),  # m
        ("least_samples", "i8"),  # of the estimation phase
        ("most_samples", "i8"),
        ("accuracy", "f8"),  # squared, that ends it
        ("acceptable", "f8"),  # squared, that is controlled with
        ("forget", "f8"),
        # memory
        ("phase", "i8"),
        ("reason", "i8"),
        ("count", "i8"),
        ("reference", "f8"),  # m, the last that was a number
        ("error", "f8"),  # m, of the relative position
        ("disturbance", "f8"),  # m
        ("outside", "f8"),  # m, relative position less both manipulators', as measured
        ("cautious", "i8"),  # whether the error has oscillated
        ("slow_given", "f8"),  # m, what both loops were given last
        ("fast_given", "f8"),
        ("blind", "i8"),  # samples in which something was no number
    ],
    align=True,
)
"""Adaptive internal model control of one axis."""

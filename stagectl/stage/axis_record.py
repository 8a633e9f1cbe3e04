"""One axis' numbers as a packed record: the coefficients its controller runs on, and its memory."""

import numpy as np

MOST_STATES = 32
"""Of a model.  Larger ones are refused: a record has room for so many."""
MOST_SERVO_STATES = 12
"""Integral and resonant states together."""

IDLE, RUNNING = range(2)
"""Of `phase`."""
GO_ON, START, CHANGE, CHANGE_MODEL = range(4)
"""Of `command`: what the next sample begins with."""

_N, _S = MOST_STATES, MOST_SERVO_STATES

AXIS = np.dtype(
    [
        # what is to happen
        ("phase", "i8"),
        ("command", "i8"),
        ("rising", "i8"),  # whether the reference's weight goes up, to 1
        ("ramp_at", "i8"),  # samples, 0 ... ramp
        ("ramp", "i8"),
        # outer loop: x+ = observer x + drive u + correction y, u = forward r - feedback x - servo_feedback s
        ("states", "i8"),
        ("servo_states", "i8"),
        ("observer", "f8", (_N, _N)),
        ("drive", "f8", _N),
        ("correction", "f8", _N),
        ("feedback", "f8", _N),
        ("servo", "f8", (_S, _S)),
        ("servo_error", "f8", _S),
        ("servo_tracking", "f8", _S),
        ("servo_feedback", "f8", _S),
        ("forward", "f8"),
        # inner loop, (2.2)
        ("proportional", "f8"),
        ("integration", "f8"),
        ("tracking", "f8"),
        ("derivative", "f8"),
        ("derivative_pole", "f8"),
        ("direct", "f8"),
        # limits; steps are per sample
        ("reference_low", "f8"),
        ("reference_high", "f8"),
        ("extension_low", "f8"),
        ("extension_high", "f8"),
        ("extension_step", "f8"),
        ("voltage_low", "f8"),
        ("voltage_high", "f8"),
        ("voltage_step", "f8"),
        ("rest", "f8"),  # m, where a hold goes to
        # memory
        ("home", "f8"),  # m, where the reference's ramp comes from
        ("position_zero", "f8"),  # m, where the model's output is zero
        ("extension_zero", "f8"),  # m, where the model's input is zero
        ("state", "f8", _N),
        ("next_state", "f8", _N),
        ("servo_state", "f8", _S),
        ("next_servo_state", "f8", _S),
        ("reference", "f8"),
        ("extension_reference", "f8"),
        ("integral", "f8"),
        ("slope", "f8"),
        ("error", "f8"),
        ("voltage", "f8"),
        # samples in which a limit was met
        ("reference_limited", "i8"),
        ("extension_limited", "i8"),
        ("voltage_limited", "i8"),
    ],
    align=True,
)

MEMORY = AXIS.names[AXIS.names.index("home") :]  # type: ignore[index,union-attr]  # a record has names
"""What `prepare` sets to zero."""

"""Force control's numbers as packed records: what it is set to, and its memory."""

import numpy as np

MOST_STATES = 8
"""Of a velocity model.  Larger ones are refused: a record has room for so many, and for its disturbance."""

IDLE, APPROACHING, ESTIMATING, CONTROLLING, RETREATING, RETREATED = range(6)
"""Of `phase`."""
FINE, OVERLOAD, SENSOR, LEAVING = range(4)
"""Of `reason`."""

_N = MOST_STATES + 1

OUTER = np.dtype(
    [
        ("stiffness", "f8"),  # K_f, N/m
        ("lag", "f8"),  # 1/s, of the velocity loop
        ("integral", "f8"),  # weight, 1/s^2
        ("velocity", "f8"),  # weight, (N s/m)^2
        ("control", "f8"),  # weight, 1
        ("period", "f8"),  # s
    ],
    align=True,
)
"""The outer problem, as `force_gain_kernel` solves it."""

CUTTING = np.dtype(
    [
        ("stiffness", "f8"),  # K_f, N/m
        ("period", "f8"),  # s
        ("force_noise", "f8"),  # variance, N^2
        ("velocity_noise", "f8"),  # variance, (m/s)^2
        ("kappa_drift", "f8"),  # variance of what it changes by in a sample
        ("beta_drift", "f8"),
        ("gate", "f8"),  # N
        ("least", "f8"),  # kappa, m/(N s)
        ("most", "f8"),
        # memory
        ("kappa", "f8"),  # m/(N s)
        ("kappa_variance", "f8"),
        ("beta", "f8"),
        ("beta_variance", "f8"),
        ("last_force", "f8"),  # N
        ("is_fresh", "i8"),  # whether that is of the sample before
    ],
    align=True,
)
"""What is believed of kappa and beta, as `cutting_estimate_kernel` estimates them."""

LOOP = np.dtype(
    [
        ("states", "i8"),
        ("transition", "f8", (_N, _N)),  # Phi
        ("inlet", "f8", _N),  # Gamma
        ("outlet", "f8", _N),  # C
        ("gain", "f8", _N),  # K
        ("feedback", "f8", _N),  # L
        ("integral", "f8"),  # L_i, 1/s
        ("forward", "f8"),  # l_r
        ("least", "f8"),  # m/s that may be asked for
        ("most", "f8"),
        ("period", "f8"),  # s
        # memory
        ("state", "f8", _N),
        ("work", "f8", _N),
        ("integrated", "f8"),  # m
        ("asked", "f8"),  # m/s
    ],
    align=True,
)
"""The inner loop, as `velocity_loop_kernel` runs it."""

FEED = np.dtype(
    [
        ("outer", OUTER),
        ("cutting", CUTTING),
        ("loop", LOOP),
        # what is wanted, and how it is come to
        ("force", "f8"),  # f_d, N
        ("initial", "f8"),  # v_init, m/s
        ("rise", "f8"),  # 1 a sample
        ("enough", "f8"),  # N
        ("approach", "f8"),  # m/s
        ("risen", "f8"),  # m/s
        ("most", "f8"),  # m/s
        ("step", "f8"),  # m/s a sample
        ("contact", "f8"),  # N
        ("contact_samples", "i8"),
        ("lost_samples", "i8"),
        ("kappa_enough", "f8"),  # variances at which control begins
        ("beta_enough", "f8"),
        ("kappa_doubt", "f8"),  # variances with which a segment begins
        ("beta_doubt", "f8"),
        ("is_adapted", "i8"),
        ("fixed_kappa", "f8"),  # m/(N s), of gains that do not adapt
        ("fixed_widening", "f8"),
        # faults
        ("overload", "f8"),  # N
        ("overload_samples", "i8"),
        ("blind_samples", "i8"),
        ("retreat", "f8"),  # m/s
        ("distance", "f8"),  # m
        # memory
        ("phase", "i8"),
        ("reason", "i8"),
        ("wanted", "f8"),  # m/s
        ("last_velocity", "f8"),  # m/s
        ("last_force", "f8"),  # N
        ("touched", "i8"),  # samples of contact
        ("lost", "i8"),  # without contact
        ("strained", "i8"),  # of overload
        ("blind", "i8"),  # without a sensor
        ("back", "f8"),  # m
    ],
    align=True,
)
"""All of force control."""

MEMORY = FEED.names[FEED.names.index("phase") :]  # type: ignore[index,union-attr]  # a record has names
"""What a segment begins without."""

"""Force control's numbers as packed records: what it is set to, and its memory."""

import numpy as np

MOST_STATES = 8
"""Of a velocity model.  Larger ones are refused: a record has room for so many, and for its disturbance."""

IDLE, APPROACHING, ESTIMATING, CONTROLLING, RETREATING, RETREATED = range(6)
"""Of `phase`."""
FINE, OVERLOAD, SENSOR, LEAVING, STUCK, UNFAMILIAR, CHATTERING = range(7)
"""Of `reason`."""
UNKNOWN, MODEL, OSCILLATION, CHATTER, RIPPLE, BRAKED, SCALE = 1, 2, 4, 8, 16, 32, 64
"""Bits of `notice`: control began before kappa and beta were known; the robot no longer follows as identified; the
loop oscillates; the tool chatters; a periodic ripple is taken out of the fed-back force; the feed was braked; kappa is
none that this material can have."""
BINS, LOW_BINS, SPACING = 29, 7, 4.0
"""Resonators at 4, 8, ... 116 Hz: how many, how many of them below 30 Hz, and Hz from one to the next."""

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
        ("guess", "f8"),  # kappa beyond which its drift is in proportion to it, m/(N s)
        ("gate", "f8"),  # N
        ("least", "f8"),  # kappa, m/(N s)
        ("most", "f8"),
        # memory
        ("kappa", "f8"),  # m/(N s)
        ("kappa_variance", "f8"),
        ("beta", "f8"),
        ("beta_variance", "f8"),
        ("kappa_left", "f8"),  # m/s and (m/s)^2, slow mean of the residuals and of their square about that
        ("kappa_scatter", "f8"),
        ("beta_left", "f8"),  # N and N^2
        ("beta_scatter", "f8"),
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

LAW = np.dtype(
    [
        ("ratio", "f8"),  # of kappa, and of the widening, to those of the gains in use, beyond which gains are renewed
        ("is_adapted", "i8"),
        ("fixed_kappa", "f8"),  # m/(N s), of gains that do not adapt
        ("fixed_widening", "f8"),
        # memory
        ("kappa", "f8"),  # m/(N s), of the gains in use; 0 where there are none
        ("widening", "f8"),
        ("on_velocity", "f8"),  # 1
        ("on_force", "f8"),  # m/(N s)
        ("on_error", "f8"),  # m/(N s^2)
        ("integral", "f8"),  # m/s
        ("changes", "i8"),  # of gains
    ],
    align=True,
)
"""The outer loop, as `force_law_kernel` runs it."""

FOLLOW = np.dtype(
    [
        ("forget", "f8"),  # 1 a sample
        ("floor", "f8"),  # m/s, below which nothing is judged
        ("patience", "i8"),  # samples
        # memory
        ("state", "f8", _N),
        ("work", "f8", _N),
        ("seen", "f8"),  # m/s, slow means
        ("foreseen", "f8"),
        ("seen_power", "f8"),  # (m/s)^2, about these
        ("foreseen_power", "f8"),
        ("error_power", "f8"),
        ("strange", "i8"),  # samples
    ],
    align=True,
)
"""Whether the robot follows as identified, as `follow_kernel` judges it."""

WAVES = np.dtype(
    [
        ("decay", "f8"),  # of a resonator in a sample
        ("slow", "f8"),  # of the mean force
        ("cosine", "f8", BINS),
        ("sine", "f8", BINS),
        ("turn", "f8"),  # rad a sample from bin to bin
        ("floor", "f8"),  # N, mean force that a ripple is at least compared with
        ("noise", "f8"),  # N, amplitude that noise alone may show
        ("share", "f8"),  # of the mean force from which on a ripple is taken out
        # memory
        ("level", "f8"),  # N, slow mean
        ("cosines", "f8", BINS),  # N, half the amplitude
        ("sines", "f8", BINS),
        ("at", "i8"),  # the highest bin
        ("omega", "f8"),  # rad a sample, of the ripple
        ("ripple_cosine", "f8"),  # N
        ("ripple_sine", "f8"),
        ("weight", "f8"),  # 0 ... 1, with which it is taken out
        ("low", "f8"),  # 1, amplitudes over the mean force
        ("high", "f8"),
        ("usual", "f8"),  # 1, slow mean of `high`
        ("samples", "i8"),  # since control began
        ("swinging", "i8"),  # samples of large low amplitude
        ("growing", "i8"),  # samples of grown high amplitude
        ("wait", "i8"),  # samples until chatter is judged again
        ("calm", "f8"),  # 1, usual amplitude before the tool chattered; 0 while it does not
        ("fading", "i8"),  # samples of an amplitude that is none of chatter
        ("answers", "i8"),  # given to this chatter
        ("lasting", "i8"),  # samples of it since all answers are given
    ],
    align=True,
)
"""Periodic parts of the force, as `wave_kernel` follows them."""

BRAKE = np.dtype(
    [
        ("share", "f8"),  # of the force wanted, beyond which it brakes
        ("slow", "f8"),  # of the scatter, in a sample
        ("noise", "f8"),  # N, least scatter
        ("samples", "i8"),  # in which the robot has followed by half
        # memory
        ("state", "f8", _N),
        ("last", "f8"),  # N
        ("scatter", "f8"),  # N, slow mean of what the force is off its mean
        ("swing", "f8"),  # N, by which the force was beyond that wanted in the present swing
        ("peak", "f8"),  # N, in those before, as it fades
        ("is_on", "i8"),
    ],
    align=True,
)
"""What stops the feed where the force rises at once, as `brake_kernel` does."""

FEED = np.dtype(
    [
        ("outer", OUTER),
        ("cutting", CUTTING),
        ("loop", LOOP),
        ("law", LAW),
        ("follow", FOLLOW),
        ("waves", WAVES),
        ("brake", BRAKE),
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
        ("activation", "f8"),  # variance at which control begins, over what it comes to
        ("hesitation", "i8"),  # samples of estimation after which it begins in any case
        ("kappa_doubt", "f8"),  # variances with which a segment begins
        ("beta_doubt", "f8"),
        ("careful_lag", "f8"),  # 1/s and 1/s^2, in place of those of `outer` where model or loop are in doubt
        ("careful_integral", "f8"),
        ("chatter_share", "f8"),  # of the feed, once the tool has chattered
        ("chatter_samples", "i8"),  # of chatter that no lower feed ends
        ("familiar", "f8"),  # 1, factor of the first guess within which kappa can be
        ("familiar_samples", "i8"),  # out of it, after which that is said
        # faults
        ("overload", "f8"),  # N
        ("overload_samples", "i8"),
        ("blind_samples", "i8"),
        ("stuck_samples", "i8"),
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
        ("stuck", "i8"),  # in which both forces are what they were before
        ("last_along", "f8"),  # N
        ("last_across", "f8"),
        ("smooth_along", "f8"),  # N, means over some samples
        ("smooth_across", "f8"),
        ("estimating", "i8"),  # samples
        ("returning", "f8"),  # m/s, at which contact is looked for
        ("cap", "f8"),  # m/s, highest feed in this segment
        ("usual", "f8"),  # m/s, slow mean of the feed wanted under control
        ("is_careful", "i8"),
        ("strange", "i8"),  # samples in which kappa is none that it can be
        ("notice", "i8"),
        ("back", "f8"),  # m
    ],
    align=True,
)
"""All of force control."""

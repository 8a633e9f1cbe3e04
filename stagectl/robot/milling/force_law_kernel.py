"""The compiled kernel of the outer loop in position form: scheduled gains, a bumpless integral, anti-windup."""

from rigkit.compiled import njit
from rigkit.record import Record
from stagectl.robot.milling import cutting_estimate_kernel as cutting
from stagectl.robot.milling import force_gain_kernel as gain


@njit(cache=True, nogil=True)
def _is_near(value: float, other: float, ratio: float) -> bool:
    return value <= ratio * other and other <= ratio * value


@njit(cache=True, nogil=True)
def adapt(feed: Record, velocity: float, force: float) -> None:
    """Renew the gains where kappa or the widening have left those in use by more than `ratio`.

    The integral takes what the change would move the output by, so the output stays.
    """
    law = feed.law
    kappa, wide = law.fixed_kappa, law.fixed_widening
    if law.is_adapted:
        kappa, wide = feed.cutting.kappa, cutting.widening(feed.cutting)
    if _is_near(kappa, law.kappa, law.ratio) and _is_near(wide, law.widening, law.ratio):
        return
    on_velocity, on_force, on_error = gain.gains(kappa, wide, feed.outer)
    law.integral += (on_velocity - law.on_velocity) * velocity + (on_force - law.on_force) * force
    law.on_velocity, law.on_force, law.on_error = on_velocity, on_force, on_error
    law.kappa, law.widening = kappa, wide
    law.changes += 1


@njit(cache=True, nogil=True)
def begin(feed: Record, velocity: float, force: float) -> None:
    """Take gains and integral such that the next feed wanted is the present one."""
    law = feed.law
    law.kappa = law.widening = law.on_velocity = law.on_force = 0.0
    law.integral = feed.wanted
    adapt(feed, velocity, force)


@njit(cache=True, nogil=True)
def wanted(law: Record, velocity: float, force: float) -> float:
    """Return the feed that is wanted, m/s, before its limits; for the velocity (m/s) and the force fed back (N)."""
    return float(law.integral - law.on_velocity * velocity - law.on_force * force)


@njit(cache=True, nogil=True)
def integrate(law: Record, error: float, period: float, asked: float, given: float) -> None:
    """Integrate the error of the force (N), unless the feed is limited on the side to which that would go on."""
    if (asked > given and error > 0.0) or (asked < given and error < 0.0):
        return
    law.integral += law.on_error * period * error

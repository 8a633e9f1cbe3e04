"""The force on the tool from the torques of the motors, and the bounds it is between: (5.2)-(5.6)."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.milling import force_kernel as kernel
from stagectl.robot.milling.force_slab_kernel import SINGULAR

TIE_BREAKS = {"centre": kernel.CENTRE, "minimum-norm": kernel.SMALLEST}
"""Which of forces that are as likely is the estimate."""


@dataclass(frozen=True, eq=False)
class ForceEstimates:
    """What a stack of torques says of the force on the tool, in base axes.

    Parameters
    ----------
    force : array, shape (samples, parts), N, and N m behind
        NaN where nothing is determined.
    low, high : array, shape (samples, parts), N and N m
        Each part over all forces that are as likely, or with slack over all that it leaves; infinite where nothing is
        determined.
    unique : array of bool, shape (samples,)
        Whether one force only is as likely.
    objective : array, shape (samples,), 1
        Of (5.6), at its least: 0 where friction alone explains the torques.
    """

    force: np.ndarray
    low: np.ndarray
    high: np.ndarray
    unique: np.ndarray
    objective: np.ndarray


def estimate_force(
    torque: np.ndarray,
    jacobian: np.ndarray,
    friction: np.ndarray,
    covariance: np.ndarray,
    tie_break: str = "centre",
    slack: np.ndarray | None = None,
) -> ForceEstimates:
    """Estimate the force on the tool; a moment there is taken to be none, but for `slack`.

    Parameters
    ----------
    torque : array, shape (samples, 6), N m
        Of the motors, gravity's taken off: tau_bar of (5.5).
    jacobian : array, shape (samples, 3 or 6, 6), m (and 1)
        Of the tool's point; only its first three rows are used.
    friction : array, shape (samples, 2, 6), N m
        Lowest and highest torque of friction, the latter larger.
    covariance : array, shape (6, 6), (N m)^2
        R_e, positive definite.
    tie_break : "centre" or "minimum-norm"
        The force that takes friction least far from the middle of its ranges, over their widths; or the smallest one.
        Either is one of those that are as likely.
    slack : array, shape (samples, 6), N m, >= 0, optional
        What noise, moment and inertia may add to each torque.  Bounds are then those of all forces with friction in its
        range widened by that, and hold the true one wherever no joint has more; they say nothing of likelihood.

    Returns
    -------
    ForceEstimates, of three parts

    Raises
    ------
    ValueError : shapes that do not fit, a tie-break there is not, an empty range, no covariance, slack < 0.

    Source
    ------
    Sornmo 2015, eqs. (5.2)-(5.6).

    Departs
    -------
    The force is the one on the tool, as a sensor there shows it, so that its torque is -J'f.  (5.6) as printed has more
    unknowns than residuals: as a rule a whole set of forces makes it least, which `low` and `high` bound.  Where (5.6)
    takes noise for what it need be at least, that set is too small: `slack` leaves out no force that may be.
    """
    torque, jacobian, friction, covariance = _checked(torque, jacobian, friction, covariance)
    slack = np.zeros(torque.shape) if slack is None else _checked_slack(slack, torque.shape)
    if tie_break not in TIE_BREAKS:
        raise ValueError(f"tie_break is {tie_break!r}, must be one of {', '.join(TIE_BREAKS)}")
    samples = len(torque)
    force, low, high = np.empty((3, samples, 3))
    unique, objective = np.empty(samples, np.bool_), np.empty(samples)
    work = np.zeros((kernel.ROWS, 6))
    which = TIE_BREAKS[tie_break]
    told = force, low, high, unique, objective
    kernel.estimate_all(torque, jacobian, friction, slack, covariance, which, *told, work)
    return ForceEstimates(force, low, high, unique, objective)


def estimate_wrench(torque: np.ndarray, jacobian: np.ndarray, friction: np.ndarray) -> ForceEstimates:
    """Estimate force and moment on the tool.

    Six torques for six unknowns: any friction within its ranges goes with some wrench, so noise has nothing to explain,
    the estimate is that of friction in the middle of its ranges, and there is never one only.

    Parameters
    ----------
    torque : array, shape (samples, 6), N m
    jacobian : array, shape (samples, 6, 6), m and 1
    friction : array, shape (samples, 2, 6), N m
        As for `estimate_force`.

    Returns
    -------
    ForceEstimates, of six parts: force, then moment about the tool's point

    Raises
    ------
    ValueError : shapes that do not fit, an empty range.

    Source
    ------
    Sornmo 2015, eqs. (5.2)-(5.6); with the middle of the ranges it becomes (4.3).
    """
    torque, jacobian, friction, _ = _checked(torque, jacobian, friction, np.eye(6))
    if jacobian.shape[1] != 6:
        raise ValueError(f"jacobian has {jacobian.shape[1]} rows, must have 6 for force and moment")
    fit = np.isfinite(torque).all(axis=1) & np.isfinite(jacobian).all(axis=(1, 2))
    size = np.linalg.norm(jacobian, axis=2)
    values = np.linalg.svd(jacobian[fit] / np.maximum(size[fit], 1e-300)[..., None], compute_uv=False)
    fit[fit] = values[:, -1] > np.sqrt(SINGULAR)
    force, low, high = np.full((3, len(torque), 6), np.nan)
    low[:], high[:] = -np.inf, np.inf
    inverse = -np.linalg.inv(jacobian[fit].swapaxes(1, 2))
    middle, half = friction[fit].mean(axis=1), 0.5 * (friction[fit, 1] - friction[fit, 0])
    force[fit] = (inverse @ (torque[fit] - middle)[..., None])[..., 0]
    reach = (np.abs(inverse) @ half[..., None])[..., 0]
    low[fit], high[fit] = force[fit] - reach, force[fit] + reach
    return ForceEstimates(force, low, high, np.zeros(len(torque), bool), np.where(fit, 0.0, np.nan))


def _checked(*given: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the arguments of `estimate_force` as arrays for the kernel; refuse what does not fit together."""
    torque, jacobian, friction, covariance = (np.ascontiguousarray(each, float) for each in given)
    samples = len(torque)
    if torque.shape != (samples, 6):
        raise ValueError(f"torque has shape {torque.shape}, must be (samples, 6)")
    if jacobian.shape not in ((samples, 3, 6), (samples, 6, 6)):
        raise ValueError(f"jacobian has shape {jacobian.shape}, must be ({samples}, 3 or 6, 6)")
    if friction.shape != (samples, 2, 6):
        raise ValueError(f"friction has shape {friction.shape}, must be ({samples}, 2, 6)")
    if (friction[:, 1] <= friction[:, 0]).any():
        sample, joint = np.argwhere(friction[:, 1] <= friction[:, 0])[0]
        low, high = friction[sample, :, joint]
        raise ValueError(f"friction of joint {joint + 1}, sample {sample}: {low:g} to {high:g} N m, must rise")
    if covariance.shape != (6, 6) or np.abs(covariance - covariance.T).max() > 1e-9 * np.abs(covariance).max():
        raise ValueError(f"covariance has shape {covariance.shape}, must be (6, 6) and symmetric")
    if not (least := np.linalg.eigvalsh(covariance)[0]) > 0:
        raise ValueError(f"covariance has the eigenvalue {least:g}, must be > 0")
    return torque, jacobian, friction, covariance


def _checked_slack(slack: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return slack as an array for the kernel; refuse what none is."""
    slack = np.ascontiguousarray(slack, float)
    if slack.shape != shape:
        raise ValueError(f"slack has shape {slack.shape}, must be {shape}")
    if not (slack >= 0).all():
        raise ValueError(f"slack is {slack[~(slack >= 0)][0]:g} N m, must be >= 0")
    return slack

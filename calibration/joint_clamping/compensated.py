"""A joint's model with the motion of the arm's side taken off, however noisy that motion was measured."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import make_smoothing_spline

from calibration.joint_clamping.correlation import correlation_length
from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.joint_model import Estimate, JointModel
from calibration.joint_clamping.torque_map import TorqueMap, TorqueMapError

PRECISE = 0.015
"""Noise of the arm's motion, over the span of the motor's, below which its shape is looked at."""
MOST_KNOTS = 1_500
"""More samples are averaged in blocks before they are smoothed."""


def extract_compensated(joint: TorqueMap, arm_motion: np.ndarray) -> JointModel:
    """Extract a joint's model from a map and the motion of the arm's side during it.

    The arm's side follows what the spring bears, so its motion is taken as a straight line over the spring's torque,
    one on either side, and a drift, fitted to what was measured.  A tracker's noise of a fifth of the whole motion then
    does not matter; subtracted sample by sample it would flatten every slope.  What a straight line leaves is the other
    joints' motors, which slide a little against their friction: where the motion is measured so well that this stands
    out of the noise, it is smoothed and taken off as well.

    Parameters
    ----------
    joint : TorqueMap
    arm_motion : array, shape (samples,), rad
        Of the actuated joint, on the joint's side of the gear.

    Raises
    ------
    TorqueMapError : a motion of another length or that is not finite, or as large as the motor's.

    Source
    ------
    Sornmo 2015, 4.3: the measured joint motion is subtracted from the motor's position.
    """
    if arm_motion.shape != joint.angle.shape or not np.isfinite(arm_motion).all():
        raise TorqueMapError(f"the arm's motion has shape {arm_motion.shape}, must be {joint.angle.shape} and finite")
    first = extract(joint)
    bears = first.spring_torque(joint.angle) - first.offset
    time = np.linspace(-1.0, 1.0, len(bears))
    scale = np.abs(bears).max()
    terms = np.column_stack([np.maximum(bears, 0), np.minimum(bears, 0), np.full(len(bears), scale), scale * time])
    weights, *_ = np.linalg.lstsq(terms, arm_motion, rcond=None)
    smooth = terms @ weights
    if not np.ptp(smooth) < 0.98 * np.ptp(joint.angle):
        raise TorqueMapError(
            f"the arm's side moves by {1e3 * np.ptp(smooth):.4g} mrad, the motor by {1e3 * np.ptp(joint.angle):.4g}: "
            "nothing is left for the gear"
        )
    left = arm_motion - smooth
    if float(np.std(np.diff(left))) < PRECISE * float(np.ptp(joint.angle)):
        more = _smoothed(left)
        smooth, left = smooth + more, left - more
    variance = float(np.mean(left**2)) * max(correlation_length(left), 1.0)
    errors = np.sqrt(variance * np.diag(np.linalg.inv(terms.T @ terms)))
    model = extract(joint.corrected(smooth))
    return replace(
        model,
        k_plus=_less_certain(model.k_plus, float(errors[0])),
        k_minus=_less_certain(model.k_minus, float(errors[1])),
    )


def _smoothed(signal: np.ndarray) -> np.ndarray:
    """Return a signal without its noise, shape (samples,): a spline whose smoothness cross-validation chooses."""
    block = max(1, len(signal) // MOST_KNOTS)
    means = signal[: len(signal) // block * block].reshape(-1, block).mean(axis=1)
    spline = make_smoothing_spline((np.arange(len(means)) + 0.5) * block - 0.5, means)
    return np.asarray(spline(np.arange(len(signal))))


def _less_certain(stiffness: Estimate, compliance_error: float) -> Estimate:
    """Add the error of the compliance that was taken off: d(1/k) = -dk / k^2."""
    return replace(stiffness, error=float(np.hypot(stiffness.error, stiffness.value**2 * compliance_error)))

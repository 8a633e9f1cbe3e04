"""A joint's map that somebody else recorded, in the units of whoever did."""

from pathlib import Path

from calibration.joint_clamping.results import LINK, JointResult, of_map
from calibration.joint_clamping.torque_map import TorqueMap
from rigkit.foreign_record import read_channels

ANGLES = {"rad": 1.0, "mrad": 1e-3, "urad": 1e-6, "deg": 0.017453292519943295, "1": 1.0}
TORQUES = {"N m": 1.0, "Nm": 1.0, "N*m": 1.0, "mN m": 1e-3, "1": 1.0}


def recorded_map(
    path: Path, names: tuple[str, str, str | None], gear: float, rate: float | None, chosen: str
) -> JointResult:
    """Read a map and extract its models.

    Parameters
    ----------
    path : Path
        CSV, WAV or HDF5.
    names : tuple of str, str, and str or None
        Channels of the motor's angle, its torque, and the arm side's angle.
    gear : float, 1
        Turns of the motor per turn of the joint.
    rate : float or None, samples/s
    chosen : str
        See `JointResult`.

    Raises
    ------
    ValueError : a gear that is 0 or not finite, or a unit that is not known.
    """
    if not 0 < abs(gear) < float("inf"):
        raise ValueError(f"--gear is {gear}, must be finite and not 0")
    channels = [name for name in names if name is not None]
    found = read_channels(path, channels, rate)
    data = found.data.astype(float)
    kinds = (ANGLES, TORQUES, ANGLES)[: len(channels)]
    scales = [_scale(*each) for each in zip(channels, found.units, kinds, strict=True)]
    joint = TorqueMap(scales[0] * data[:, 0] / gear, scales[1] * data[:, 1] * gear, found.rate)
    return of_map(joint, {LINK: scales[2] * data[:, 2]} if len(channels) == 3 else {}, chosen=chosen)


def _scale(name: str, unit: str, known: dict[str, float]) -> float:
    if unit not in known:
        raise ValueError(f"channel {name}: the unit is {unit!r}, must be one of {', '.join(known)}")
    return known[unit]

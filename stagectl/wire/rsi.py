"""The telegrams of KUKA's Robot Sensor Interface over UDP: XML <-> SI numbers.

Each 4 ms the controller sends `Rob`; the answer, `Sen`, repeats its IPOC and comes within the cycle.  Corrections are
absolute: they add to the set-point at which RSI was switched on, for the axes (`AK`, deg) and for the tool (`RKorr`,
mm and deg, in the axes of BASE).  Angles are those of `irb140.toml`: upright upper arm, level forearm, joint 1
counterclockwise from above; a KUKA has A2 = -90 and A3 = 90 deg there, and turns A1, A4 and A6 the other way round.

Source: KUKA.RobotSensorInterface 3.x as ros-industrial/kuka_experimental (kuka_rsi_hw_interface: telegrams,
EthernetConfig; its URDFs: axes) and kroshu/kuka-external-control-sdk use it.  `Corr`, `Shift`, `Out` and `Set` are
names of ours, wired to objects of the context that `stagectl robot-files kuka` writes.
"""

import math
import re
from collections.abc import Sequence
from xml.etree import ElementTree

import numpy as np

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.robot import Command, Outputs, Report

SENDER = "Vibrostage"
"""Type of `Sen`, SENTYPE of the controller's configuration."""
JOINTS = ("A1", "A2", "A3", "A4", "A5", "A6")
FRAME = ("X", "Y", "Z", "A", "B", "C")
OUTPUTS = ("Clamp", "Block")
REACH = np.radians(90.0)
"""Rad by which a joint goes from where RSI was switched on; AXISCORR of the context clamps beyond it in silence."""
SHIFT, TURN = 0.05, np.radians(2.0)
"""m along an axis and rad by which the tool does; POSCORR clamps beyond them."""
PERIOD = 4
"""ms of a cycle, by which IPOC grows."""
MODULUS = 1 << 62
_SIGN = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0])
_ZERO = np.radians([0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
_MM, _MS = 1e-3, 1e-3
_LONGEST = 4_096
_LARGEST = {"deg": 1e3, "mm": 1e5, "A": 1e4}
_STILL = np.radians(0.01)
"""Rad by which the set-point under the corrections may differ from telegram to telegram."""
_NONE = 1e-3
"""deg and mm: a correction that is as good as none."""
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)
_COUNT = re.compile(r"\d{1,18}", re.ASCII)


class Rsi:
    """RSI's telegrams as a `RobotWire`: remembers the set-point at which RSI was switched on."""

    modulus, is_whole = MODULUS, True

    def __init__(self) -> None:
        self._base: np.ndarray | None = None
        self._frame, self._is_on = np.zeros(7), [False, False]

    def read(self, data: bytes) -> Report:
        """Return what a telegram of the controller says; `GarbledError` that names what is wrong in it."""
        rob = _parsed("Rob", data)
        base, frame, pose = _joints(rob, "ASPos"), _pose(rob, "RSol"), _pose(rob, "RIst")
        if (frame if self._base is None else self._frame)[3:] @ pose[3:] < 0.0:
            pose[3:] *= -1.0  # the same turn; whoever subtracts two wants them alike
        moved = 0.0 if self._base is None else float(np.abs(base - self._base).max())
        stamp, applied, shift = _stamp(rob), _numbers(rob, "Corr", JOINTS, "deg"), _numbers(rob, "Shift", FRAME, "mm")
        report = Report(
            stamp // PERIOD,
            _MS * stamp,
            _joints(rob, "AIPos"),
            base + _SIGN * np.radians(applied),
            pose,
            stamp=stamp,
            overdue=_count(rob, "Delay", "D"),
            current=_SIGN * _numbers(rob, "MACur", JOINTS, "A"),
            outputs=Outputs(*(_flag(rob, "Out", name) for name in OUTPUTS)),
            fault=""
            if moved <= _STILL
            else f"the set-point under RSI's corrections has moved by {np.degrees(moved):.3g} deg, must stay",
        )
        if self._base is None:
            self._base, self._frame = base, frame
            self._is_on = [bool(np.abs(each).max() > _NONE) for each in (applied, shift)]
        return report

    def write(self, command: Command, report: Report) -> bytes:
        """Return the answer to a report; `WireError` where a number is not finite, or it asks for nothing."""
        wanted = command.pose if command.joint_angle is None else command.joint_angle
        if self._base is None or wanted is None or not np.isfinite(wanted).all():
            raise WireError(f"Sen: {wanted} cannot be sent, must be finite angles or a pose, after a telegram")
        if reason := self._mixed(wanted):
            raise WireError(f"Sen: {reason}")
        joints = frame = [0.0] * 6
        if command.joint_angle is not None:
            joints = np.degrees(_SIGN * (wanted - self._base)).tolist()
        else:
            frame = self._shift(wanted)
        outputs = command.outputs or report.outputs or Outputs()
        return (
            f'<Sen Type="{SENDER}">{_element("AK", JOINTS, joints)}{_element("RKorr", FRAME, frame)}'
            f'<Set Clamp="{int(outputs.clamp)}" Block="{int(outputs.block)}"/><IPOC>{report.stamp}</IPOC></Sen>'
        ).encode("ascii")

    def refusal(self, wanted: np.ndarray) -> str:
        """Say why angles, shape (6,), rad, or a pose, shape (7,), m and 1, are beyond RSI's corrections, or nothing."""
        if self._base is None or not np.isfinite(wanted).all():
            return ""
        if reason := self._mixed(wanted):
            return reason
        since = "from where RSI was switched on, must be"
        if len(wanted) == len(JOINTS):
            far = np.abs(wanted - self._base)
            joint = int(far.argmax())
            if far[joint] > REACH:
                asked = f"{np.degrees(far[joint]):.4g} deg {since} <= {np.degrees(REACH):g} deg"
                return f"joint {joint + 1} is asked to {asked}"
            return ""
        shift = self._shift(wanted)
        moved, turned = max(map(abs, shift[:3])), math.hypot(*shift[3:])
        if moved > SHIFT / _MM:
            return f"the tool is asked to {moved:.4g} mm {since} <= {SHIFT / _MM:g} mm along each axis"
        if turned > np.degrees(TURN):
            return f"the tool is asked to turn by {turned:.4g} deg {since} <= {np.degrees(TURN):g} deg"
        return ""

    def forget(self) -> None:
        """Take the next telegram's set-point for the one that corrections add to."""
        self._base = None

    def _mixed(self, wanted: np.ndarray) -> str:
        """Say that an earlier program has left corrections of the other kind, which an answer would take back at once.

        Unanswered, the controller keeps them, and the robot stands still.
        """
        is_joints = len(wanted) == len(JOINTS)
        if not self._is_on[is_joints]:
            return ""
        axes, tool = "of the axes", "of the tool"
        return (
            f"corrections {tool if is_joints else axes} are on, must be none for those "
            f"{axes if is_joints else tool}: start the robot's program again"
        )

    def _shift(self, wanted: np.ndarray) -> list[float]:
        """Return X Y Z (mm) and A B C (deg) from the set-point's frame to a pose; the turn is small."""
        base = self._frame
        w, v = base[3], base[4:]
        turned = (
            2.0 * (w * wanted[4:] - wanted[3] * v - np.cross(wanted[4:], v)) * math.copysign(1.0, base[3:] @ wanted[3:])
        )
        return [*((wanted[:3] - base[:3]) / _MM).tolist(), *np.degrees(turned[::-1]).tolist()]


def pack_telegram(report: Report, base: np.ndarray, frame: np.ndarray, shift: np.ndarray) -> bytes:
    """Return what a controller sends.

    Parameters
    ----------
    report : Report
        With currents and outputs; its stamp is IPOC, ms.
    base : array, shape (6,), rad
        Set-point at which RSI was switched on.
    frame : array, shape (7,), m and 1
        The tool's pose there.
    shift : array, shape (6,), m and rad
        Correction of the tool that is applied.

    Raises
    ------
    WireError : a number is not finite.
    """
    current = np.zeros(6) if report.current is None else report.current
    outputs = report.outputs or Outputs()
    parts = {
        "RIst": (FRAME, _placed(report.pose)),
        "RSol": (FRAME, _placed(frame)),
        "AIPos": (JOINTS, _axes(report.joint_angle)),
        "ASPos": (JOINTS, _axes(base)),
        "MACur": (JOINTS, (_SIGN * current).tolist()),
        "Corr": (JOINTS, np.degrees(_SIGN * (report.planned_angle - base)).tolist()),
        "Shift": (FRAME, [*(shift[:3] / _MM).tolist(), *np.degrees(shift[3:]).tolist()]),
    }
    wrong = [name for name, (_, values) in parts.items() if not all(map(math.isfinite, values))]
    if wrong:
        raise WireError(f"Rob: {', '.join(wrong)} cannot be sent, must be finite")
    return (
        '<Rob Type="KUKA">'
        + "".join(_element(name, keys, values) for name, (keys, values) in parts.items())
        + f'<Delay D="{report.overdue}"/><Out Clamp="{int(outputs.clamp)}" Block="{int(outputs.block)}"/>'
        f"<IPOC>{report.stamp}</IPOC></Rob>"
    ).encode("ascii")


def unpack_answer(data: bytes) -> tuple[int, np.ndarray, np.ndarray, Outputs]:
    """Return IPOC, the correction of the joints, shape (6,), rad, of the tool, shape (6,), m and rad, and the outputs.

    Raises
    ------
    GarbledError : it is none.
    """
    sen = _parsed("Sen", data)
    frame = _numbers(sen, "RKorr", FRAME, "mm")
    moved = np.concatenate([_MM * frame[:3], np.radians(frame[3:])])
    joints = _SIGN * np.radians(_numbers(sen, "AK", JOINTS, "deg"))
    return _stamp(sen), joints, moved, Outputs(*(_flag(sen, "Set", name) for name in OUTPUTS))


def _parsed(name: str, data: bytes) -> ElementTree.Element:
    if len(data) > _LONGEST or b"<!" in data or b"<?" in data:
        raise GarbledError(f"{name}: {len(data)} bytes are no telegram, must be <= {_LONGEST} of elements alone")
    try:
        found = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as fault:
        raise GarbledError(f"{name}: {len(data)} bytes are no XML: {fault}") from None
    if found.tag != name:
        raise GarbledError(f"{name}: is {found.tag[:20]!r}")
    return found


def _child(telegram: ElementTree.Element, name: str) -> ElementTree.Element:
    found = telegram.findall(name)
    if len(found) != 1:
        raise GarbledError(f"{telegram.tag}: has {len(found)} of {name}, must have one")
    return found[0]


def _numbers(telegram: ElementTree.Element, name: str, keys: Sequence[str], unit: str) -> np.ndarray:
    """Return the numbers of an element; those of a frame are mm, then deg."""
    element, limit = _child(telegram, name), _LARGEST[unit]
    texts = [element.get(key, "") for key in keys]
    for key, text in zip(keys, texts, strict=True):
        if not (_NUMBER.fullmatch(text) and abs(float(text)) <= limit):
            raise GarbledError(
                f"{telegram.tag}: {name}.{key} is {text[:20]!r}, must be a number within {limit:g} {unit}"
            )
    return np.array([float(text) for text in texts])


def _joints(telegram: ElementTree.Element, name: str) -> np.ndarray:
    return np.asarray(_SIGN * (np.radians(_numbers(telegram, name, JOINTS, "deg")) - _ZERO))


def _axes(angle: np.ndarray) -> list[float]:
    return np.degrees(_SIGN * angle + _ZERO).tolist()  # type: ignore[no-any-return]


def _count(telegram: ElementTree.Element, name: str, key: str) -> int:
    text = _child(telegram, name).get(key, "")
    if not _COUNT.fullmatch(text):
        raise GarbledError(f"{telegram.tag}: {name}.{key} is {text[:20]!r}, must be a whole number >= 0")
    return int(text)


def _flag(telegram: ElementTree.Element, name: str, key: str) -> bool:
    text = _child(telegram, name).get(key, "")
    if text not in ("0", "1"):
        raise GarbledError(f"{telegram.tag}: {name}.{key} is {text[:20]!r}, must be 0 or 1")
    return text == "1"


def _stamp(telegram: ElementTree.Element) -> int:
    text = _child(telegram, "IPOC").text or ""
    if not _COUNT.fullmatch(text):
        raise GarbledError(f"{telegram.tag}: IPOC is {text[:20]!r}, must be a whole number >= 0")
    return int(text)


def _element(name: str, keys: Sequence[str], values: Sequence[float]) -> str:
    return f"<{name} " + " ".join(f'{key}="{value:.8f}"' for key, value in zip(keys, values, strict=True)) + "/>"


def _pose(telegram: ElementTree.Element, name: str) -> np.ndarray:
    """Return a pose, m and quaternion w x y z, of X Y Z (mm) and A B C (deg): turns about z, then y, then x."""
    frame = _numbers(telegram, name, FRAME, "mm")
    (ca, cb, cc), (sa, sb, sc) = (turn(0.5 * np.radians(frame[3:])) for turn in (np.cos, np.sin))
    quaternion = (
        ca * cb * cc + sa * sb * sc,
        ca * cb * sc - sa * sb * cc,
        ca * sb * cc + sa * cb * sc,
        sa * cb * cc - ca * sb * sc,
    )
    return np.array([*(_MM * frame[:3]), *quaternion])


def _placed(pose: np.ndarray) -> list[float]:
    """Return X Y Z (mm) and A B C (deg) of a pose, m and 1."""
    w, x, y, z = pose[3:]
    a = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    b = math.asin(min(1.0, max(-1.0, 2 * (w * y - z * x))))
    c = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return [*(pose[:3] / _MM).tolist(), *map(math.degrees, (a, b, c))]

"""RSI's telegrams: there and back, against one written by hand as a controller sends it, and bytes that are none."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.robot import Command, Outputs, Report
from stagectl.wire.rsi import REACH, Rsi, pack_telegram, unpack_answer

ANGLES = np.radians([10.0, -20.0, 30.0, 0.0, 45.0, 90.0])
POSE = np.array([0.515, -0.1, 0.712, *(np.array([4.0, 5.0, -5.0, 5.0]) / np.sqrt(91.0))])
AMPERE = np.array([1.0, -2.0, 3.0, -4.0, 5.0, -6.0])
REPORT = Report(
    250, 1.0, ANGLES + 1e-3, ANGLES + 2e-3, POSE, stamp=1_000, overdue=3, current=AMPERE, outputs=Outputs(clamp=True)
)
TELEGRAM = pack_telegram(REPORT, ANGLES, POSE, np.zeros(6))
AT_REST = pack_telegram(replace(REPORT, planned_angle=ANGLES), ANGLES, POSE, np.zeros(6))
BY_HAND = (
    b'<Rob Type="KUKA"><RIst X="1420.0" Y="0.0" Z="1860.5" A="0.0" B="90.0" C="0.0"/>'
    b'<RSol X="1420.0" Y="0.0" Z="1860.5" A="0.0" B="90.0" C="0.0"/>'
    b'<AIPos A1="10.0" A2="-90.0" A3="90.0" A4="0.0" A5="30.0" A6="-5.0"/>'
    b'<ASPos A1="10.0" A2="-90.0" A3="90.0" A4="0.0" A5="30.0" A6="-5.0"/>'
    b'<MACur A1="0.5" A2="-1.5" A3="0.0" A4="0.0" A5="0.0" A6="0.0"/>'
    b'<Corr A1="0.0" A2="0.0" A3="0.0" A4="0.0" A5="0.0" A6="0.0"/>'
    b'<Shift X="0.0" Y="0.0" Z="0.0" A="0.0" B="0.0" C="0.0"/>'
    b'<Delay D="0"/><Out Clamp="0" Block="1"/><IPOC>4208163634</IPOC></Rob>'
)


def test_a_telegram_comes_back_as_it_went() -> None:
    found = Rsi().read(TELEGRAM)
    assert (found.counter, found.time, found.stamp, found.overdue) == (250, 1.0, 1_000, 3)
    assert (found.outputs, found.fault) == (Outputs(clamp=True), "")
    assert found.current is not None
    for name in ("joint_angle", "planned_angle", "current"):
        np.testing.assert_allclose(getattr(found, name), getattr(REPORT, name), atol=1e-9)
    np.testing.assert_allclose(found.pose[:3], POSE[:3], atol=1e-9)
    assert abs(found.pose[3:] @ POSE[3:]) == pytest.approx(1.0)  # q and -q are one turn


def test_the_axes_of_a_kuka_are_those_of_the_arms_files() -> None:
    """Upright upper arm, level forearm: A2 = -90, A3 = 90 deg; A1, A4, A6 turn the other way round."""
    found = Rsi().read(BY_HAND)
    np.testing.assert_allclose(np.degrees(found.joint_angle), [-10.0, 0.0, 0.0, 0.0, 30.0, 5.0], atol=1e-12)
    np.testing.assert_allclose(found.current, [-0.5, -1.5, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(found.pose, [1.42, 0.0, 1.8605, 0.5**0.5, 0.0, 0.5**0.5, 0.0], atol=1e-12)
    assert (found.counter, found.outputs) == (1_052_040_908, Outputs(block=True))


def test_answers_add_to_where_rsi_was_switched_on_and_repeat_its_ipoc() -> None:
    wire = Rsi()
    report = wire.read(TELEGRAM)
    answer = wire.write(Command(1, 0.0, joint_angle=ANGLES + 0.1), report)
    ipoc, joints, frame, outputs = unpack_answer(answer)
    np.testing.assert_allclose(joints, np.full(6, 0.1), atol=1e-9)
    assert (ipoc, outputs, frame.any()) == (1_000, Outputs(clamp=True), np.False_)
    sen = ElementTree.fromstring(answer)
    assert (sen.tag, sen.get("Type"), sen.findtext("IPOC")) == ("Sen", "Vibrostage", "1000")
    element = sen.find("AK")
    assert element is not None
    assert float(element.get("A1", "")) == pytest.approx(-np.degrees(0.1))
    assert float(element.get("A2", "")) == pytest.approx(np.degrees(0.1))


def test_a_pose_moves_the_tool_and_turns_it_a_little() -> None:
    wire = Rsi()
    report = wire.read(AT_REST)
    turned, half = POSE.copy(), 0.5 * np.array([1e-3, -2e-3, 3e-3])
    turned[:3] += 1e-3, 0.0, -2e-3
    turned[3:] = np.array([POSE[3] - half @ POSE[4:], *(POSE[4:] + half * POSE[3] + np.cross(half, POSE[4:]))])
    command = Command(1, 0.0, pose=turned, outputs=Outputs(block=True))
    _, joints, frame, outputs = unpack_answer(wire.write(command, report))
    np.testing.assert_allclose(frame, [1e-3, 0.0, -2e-3, 3e-3, -2e-3, 1e-3], atol=1e-8)  # A is about z
    assert (outputs, joints.any()) == (Outputs(block=True), np.False_)


def test_what_is_too_far_is_refused_by_name() -> None:
    wire = Rsi()
    assert wire.refusal(ANGLES) == ""
    wire.read(AT_REST)
    assert wire.refusal(ANGLES + 0.999 * REACH) == ""
    text = "joint 1 is asked to 90.5 deg from where RSI was switched on, must be <= 90 deg"
    assert wire.refusal(ANGLES + REACH + np.radians(0.5)) == text
    assert "60 mm from where" in wire.refusal(POSE + np.array([0.06, 0, 0, 0, 0, 0, 0]))
    assert "asked to turn by" in wire.refusal(np.array([*POSE[:3], 1.0, 0.0, 0.0, 0.0]))
    with pytest.raises(WireError, match="cannot be sent"):
        wire.write(Command(1, 0.0, joint_angle=np.full(6, np.nan)), REPORT)
    with pytest.raises(WireError, match="cannot be sent"):
        wire.write(Command(1, 0.0), REPORT)
    with pytest.raises(WireError, match="RIst cannot be sent"):
        pack_telegram(Report(1, 0.0, ANGLES, ANGLES, np.full(7, np.nan)), ANGLES, POSE, np.zeros(6))


def test_a_set_point_that_moves_under_the_corrections_is_a_fault() -> None:
    wire = Rsi()
    wire.read(TELEGRAM)
    moved = wire.read(pack_telegram(REPORT, ANGLES + 1e-3, POSE, np.zeros(6)))
    assert moved.fault == "the set-point under RSI's corrections has moved by 0.0573 deg, must stay"
    wire.forget()
    assert wire.read(pack_telegram(REPORT, ANGLES + 1e-3, POSE, np.zeros(6))).fault == ""


@pytest.mark.parametrize(
    ("good", "bad", "reason"),
    [
        (b"</Rob>", b"", "are no XML"),
        (b'A3="120', b'A3="nan', "A[IS]Pos.A3 is 'nan.* must be a number within 1000 deg"),
        (b'A3="120', b'A3="1_2', "A[IS]Pos.A3 is '1_2"),
        (b'A3="120', b'A3="1e9', "A[IS]Pos.A3 is '1e9"),
        (b'A3="120', b'B3="120', "A[IS]Pos.A3 is ''"),
        (b"<IPOC>1000", b"<IPOC>-4", "IPOC is '-4', must be a whole number"),
        (b"<IPOC>1000", b"<IPOC>" + 40 * b"9", "IPOC is '99999"),
        (b"<IPOC>1000</IPOC>", b"", "has 0 of IPOC, must have one"),
        (b"<IPOC>1000</IPOC>", 2 * b"<IPOC>1000</IPOC>", "has 2 of IPOC"),
        (b'D="3"', b'D="x"', "Delay.D is 'x'"),
        (b'Clamp="1"', b'Clamp="2"', "Out.Clamp is '2', must be 0 or 1"),
        (b"<Rob ", b"<!DOCTYPE r><Rob ", "are no telegram"),
        (b"Rob", b"Sen", "is 'Sen'"),
        (b"<Delay", 5_000 * b" " + b"<Delay", "are no telegram, must be <= 4096"),
    ],
)
def test_what_is_wrong_with_a_telegram_is_named(good: bytes, bad: bytes, reason: str) -> None:
    assert good in TELEGRAM
    with pytest.raises(GarbledError, match=reason):
        Rsi().read(TELEGRAM.replace(good, bad))


def test_an_answer_that_is_none_is_named() -> None:
    wire = Rsi()
    answer = wire.write(Command(1, 0.0, joint_angle=ANGLES), wire.read(TELEGRAM))
    for good, bad, reason in ((b"<AK", b"<BK", "has 0 of AK"), (b'Block="0"', b"", "Set.Block is ''")):
        with pytest.raises(GarbledError, match=reason):
            unpack_answer(answer.replace(good, bad))


@given(st.binary(max_size=200))
def test_any_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(GarbledError):
        Rsi().read(data)


@given(st.integers(0, len(TELEGRAM) - 1), st.binary(max_size=8), st.integers(0, 8))
def test_any_damage_is_refused_or_still_finite(at: int, put: bytes, left_out: int) -> None:
    damaged = TELEGRAM[:at] + put + TELEGRAM[at + left_out :]
    try:
        found = Rsi().read(damaged)
    except GarbledError:
        return
    for values in (found.joint_angle, found.planned_angle, found.pose, found.current):
        assert values is not None
        assert np.isfinite(values).all()


@pytest.mark.parametrize(
    ("left", "command", "reason"),
    [
        ("axes", Command(1, 0.0, pose=POSE), "of the axes are on, must be none for those of the tool"),
        ("tool", Command(1, 0.0, joint_angle=ANGLES), "of the tool are on, must be none for those of the axes"),
    ],
)
def test_what_a_program_of_the_other_kind_has_left_is_not_taken_back_in_a_jump(
    left: str, command: Command, reason: str
) -> None:
    wire = Rsi()
    shift = np.full(6, 1e-4 if left == "tool" else 0.0)
    planned = ANGLES + (1e-3 if left == "axes" else 0.0)
    report = wire.read(pack_telegram(Report(1, 0.0, planned, planned, POSE), ANGLES, POSE, shift))
    wanted = command.pose if command.joint_angle is None else command.joint_angle
    assert wanted is not None
    assert reason in wire.refusal(wanted)
    with pytest.raises(WireError, match=reason):
        wire.write(command, report)

"""Damaged datagrams and lines of robot, tracker and force sensor."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rigkit.wire.layout import GarbledError
from stagectl.wire import egm, force_sensor, robot, rsi, tracker
from tests.fuzz.judge import Finding, is_accepted
from tests.fuzz.mutation import mutated, of_bytes

COUNTS = np.full(6, 1e6)


def cases(_: Path) -> Callable[[int], bool]:
    """Return what takes the damaged bytes of a number, and says whether they passed for sound ones."""

    def case(number: int) -> bool:
        chance = random.Random(number)
        return chance.choice((_report, _command, _telegram, _answer, _tracked, _force, _request))(chance)

    return case


def _damaged(sound: bytes, chance: random.Random) -> bytes:
    return mutated(sound, chance, [sound, chance.randbytes(64)], of_bytes)


def _numbers(chance: random.Random, count: int) -> np.ndarray:
    return np.array([chance.uniform(-1, 1) for _ in range(count)])


def _pose(chance: random.Random) -> np.ndarray:
    turn = _numbers(chance, 4)
    return np.concatenate([_numbers(chance, 3), turn / np.linalg.norm(turn)])


def _report(chance: random.Random) -> bool:
    sound = egm.pack_report(robot.Report(7, 1.0, _numbers(chance, 6), _numbers(chance, 6), _pose(chance)))
    data = _damaged(sound, chance)

    def check(found: robot.Report) -> None:
        assert np.isfinite(found.joint_angle).all(), "joint_angle"
        assert np.isfinite(found.planned_angle).all(), "planned_angle"
        assert found.joint_angle.shape == found.planned_angle.shape == (6,)
        _check_pose(found.pose)

    return is_accepted(lambda: egm.unpack_report(data), check, GarbledError)


def _command(chance: random.Random) -> bool:
    wanted: dict[str, Any] = chance.choice(({"joint_angle": _numbers(chance, 6)}, {"pose": _pose(chance)}))
    data = _damaged(egm.pack_command(robot.Command(7, 1.0, **wanted)), chance)

    def check(found: robot.Command) -> None:
        assert (found.joint_angle is None) != (found.pose is None), "both or nothing"
        if found.joint_angle is not None:
            assert found.joint_angle.shape == (6,)
            assert np.isfinite(found.joint_angle).all(), "joint_angle"
        if found.pose is not None:
            assert np.isfinite(found.pose).all(), "pose"
            _check_pose(found.pose)

    return is_accepted(lambda: egm.unpack_command(data), check, GarbledError)


def _telegram(chance: random.Random) -> bool:
    said = robot.Report(7, 1.0, _numbers(chance, 6), _numbers(chance, 6), _pose(chance), stamp=28)
    data = _damaged(rsi.pack_telegram(said, _numbers(chance, 6), _pose(chance), _numbers(chance, 6)), chance)

    def check(found: robot.Report) -> None:
        assert np.isfinite(found.joint_angle).all(), "joint_angle"
        assert np.isfinite(found.planned_angle).all(), "planned_angle"
        assert found.current is not None, "no current"
        assert np.isfinite(found.current).all(), "current"
        assert found.joint_angle.shape == found.planned_angle.shape == found.current.shape == (6,)
        _check_pose(found.pose)

    return is_accepted(lambda: rsi.Rsi().read(data), check, GarbledError)


def _answer(chance: random.Random) -> bool:
    wire = rsi.Rsi()
    said = robot.Report(7, 1.0, _numbers(chance, 6), _numbers(chance, 6), _pose(chance), stamp=28)
    report = wire.read(rsi.pack_telegram(said, _numbers(chance, 6), _pose(chance), np.zeros(6)))  # none of the tool's
    data = _damaged(wire.write(robot.Command(7, 1.0, joint_angle=_numbers(chance, 6)), report), chance)

    def check(found: tuple[int, np.ndarray, np.ndarray, robot.Outputs]) -> None:
        assert found[0] >= 0, "ipoc"
        assert np.isfinite(found[1]).all(), "joints"
        assert np.isfinite(found[2]).all(), "frame"

    return is_accepted(lambda: rsi.unpack_answer(data), check, GarbledError)


def _check_pose(pose: np.ndarray) -> None:
    is_there = np.isfinite(pose)
    assert is_there.all() or not is_there.any(), f"pose {pose}"
    assert not is_there.all() or abs(np.linalg.norm(pose[3:]) - 1) < 2e-3, f"pose {pose}"


def _tracked(chance: random.Random) -> bool:
    """Take two samples of which the second is damaged: the first is always heard, and the rest does not grow."""
    sight = tracker.Sighting(7, 5, 1e-4, _pose(chance))
    sound = tracker.pack_sample(tracker.Sample(7, 1.0, (sight,) * chance.randrange(1, 4)))
    packets, found = tracker.Packets(), []
    data = sound + _damaged(sound, chance)
    is_accepted(lambda: found.extend(packets.take(data)), lambda _: None, ())
    if not found or found[0].counter != 7:
        raise Finding("the sample before the damaged one is not heard")
    if len(packets._rest) > len(data):  # noqa: SLF001
        raise Finding("the rest grows")
    return len(found) > 1


def _force(chance: random.Random) -> bool:
    records = (force_sensor.Record(n, n, 0, _numbers(chance, 6)) for n in range(chance.randrange(1, 4)))
    data = _damaged(b"".join(force_sensor.pack_record(each, COUNTS) for each in records), chance)

    def check(found: list[force_sensor.Record]) -> None:
        assert found, "nothing"
        assert all(np.isfinite(each.wrench).all() and each.wrench.shape == (6,) for each in found), "wrench"

    return is_accepted(lambda: force_sensor.unpack_records(data, COUNTS), check, GarbledError)


def _request(chance: random.Random) -> bool:
    data = _damaged(force_sensor.pack_request(chance.choice(list(force_sensor.Request)), 1), chance)

    def check(found: tuple[force_sensor.Request, int]) -> None:
        assert isinstance(found[0], force_sensor.Request)
        assert found[1] >= 0

    return is_accepted(lambda: force_sensor.unpack_request(data), check, GarbledError)

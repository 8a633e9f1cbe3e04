import numpy as np
import pytest

from ctlblocks import Graph
from firmware_sim.clamped_robot import ClampedRobot
from stagectl.robot.arm import irb140
from stagectl.robot.clamp_procedure import ClampLimits, ClampProcedure
from stagectl.robot.clamp_search import ClampSearch

RATE = 250.0
HOME = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
POSE = HOME + np.radians([5.0, 5.0, -5.0, 10.0, 10.0, 5.0])


def limits(**other: object) -> ClampLimits:
    given: dict[str, object] = {
        "softness": np.full(6, 0.5),
        "speed": np.full(6, 0.05),
        "approach": 0.5,
        "torque": np.array([200.0, 300.0, 160.0, 40.0, 36.0, 20.0]),
        "turn": np.array([60.0, 90.0, 50.0, 20.0, 18.0, 10.0]),
        "proof": np.array([30.0, 45.0, 25.0, 10.0, 9.0, 5.0]),
        "quiet": np.array([6.0, 8.0, 6.0, 1.5, 1.5, 1.0]),
        "travel": np.full(6, 20e-3),
        "reach": np.full(6, 0.3),
        "search_step": np.full(6, 10e-3),
        "rounds": 60,
        "settle": 0.04,
        "cycles": 2,
        "patience": 1.0,
    }
    return ClampLimits(**(given | other))  # type: ignore[arg-type]


def procedure(joints: tuple[int, ...] = (0,), **other: object) -> ClampProcedure:
    return ClampProcedure(irb140().with_tool(0.1), POSE, HOME, joints, limits(**other))


class Cell:
    """The procedure and a simulated robot; `log` holds joint, reference, torque and angle of every sample."""

    def __init__(self, made: ClampProcedure, **robot: float) -> None:
        self.search, self.robot = ClampSearch(made), ClampedRobot(seed=3, **robot)  # type: ignore[arg-type]
        self.graph = Graph(RATE)
        self.graph.add("robot", self.robot)
        self.graph.add("search", self.search)
        for port in self.search.inputs:
            self.graph.connect(f"robot.{port.name}", f"search.{port.name}")
        for name in ("reference", "soft", "clamp"):
            self.graph.connect(f"search.{name}", f"robot.{name}", delayed=True)
        self.graph.prepare()
        self.log: list[tuple[int, int, np.ndarray, np.ndarray, np.ndarray]] = []

    def run(self, seconds: float) -> None:
        signal = self.graph.signal
        for _ in range(round(seconds * RATE)):
            self.graph.tick()
            moved, reference = int(signal("search.joint")[0, 0]), signal("search.reference")[0].copy()
            seen = signal("robot.torque")[0].copy(), signal("robot.angle")[0].copy()
            self.log.append((self.search.step, moved, reference, *seen))
            if self.search.done or self.search.cause is not None:
                return

    def until(self, kind: str) -> None:
        while not self.search.done and self.search.steps[self.search.step].kind != kind:
            self.run(1 / RATE)


def test_a_simulated_arm_is_clamped_measured_and_let_go() -> None:
    cell = Cell(procedure((0, 2)))
    cell.run(200.0)
    assert cell.search.cause is None
    assert cell.search.done
    for joint in (0, 2):
        torque = np.array([row[3][joint] for row in cell.log if row[1] == joint + 1])
        turn = cell.search.procedure.limits.turn[joint]
        assert turn < torque.max() < 1.1 * turn
        assert -turn > torque.min() > -1.1 * turn
        turns = np.diff(np.sign(torque[np.abs(torque) > 0.9 * turn]))
        assert np.count_nonzero(turns) == 4  # two cycles
    np.testing.assert_allclose(cell.log[-1][4], HOME, atol=2e-3)


def test_the_search_ends_where_every_joint_is_quiet() -> None:
    cell = Cell(procedure())
    cell.until("search")
    loud = np.abs(cell.log[-1][3]) > limits().quiet
    cell.until("alternate")
    assert loud.any()
    torques = np.array([row[3] for row in cell.log[-50:]])
    assert (np.abs(torques.mean(axis=0)) < 1.5 * limits().quiet).all()


def test_references_go_no_faster_than_they_may() -> None:
    cell = Cell(procedure())
    cell.run(200.0)
    speed = np.abs(np.diff([row[2] for row in cell.log], axis=0)).max(axis=1) * RATE
    free = np.array([cell.search.steps[min(row[0], len(cell.search.steps) - 1)].kind == "move" for row in cell.log])[1:]
    assert speed[free].max() < 0.5 * 1.001
    assert speed[~free].max() < 0.05 * 1.001


def test_a_clamp_that_slips_is_found_by_its_name_and_the_arm_holds() -> None:
    cell = Cell(procedure(), slip=40.0)
    cell.run(200.0)
    assert cell.search.cause is not None
    assert "slips" in cell.search.cause or "is it clamped" in cell.search.cause
    last = cell.log[-1][2]
    for _ in range(100):
        cell.graph.tick()
    np.testing.assert_array_equal(cell.graph.signal("search.reference")[0], last)
    assert cell.graph.signal("search.clamp")[0, 0] == 1.0


def test_an_arm_that_is_not_held_at_all_fails_the_clamp_check() -> None:
    cell = Cell(procedure(), slip=1.0)
    cell.run(200.0)
    assert cell.search.steps[cell.search.step].kind == "check"
    assert cell.search.cause is not None


def test_a_pause_stops_all_motion_and_it_goes_on_from_there() -> None:
    cell = Cell(procedure())
    cell.until("alternate")
    cell.run(0.5)
    cell.search.pause()
    held = cell.graph.signal("search.reference")[0].copy()
    cell.run(0.5)
    np.testing.assert_array_equal(cell.graph.signal("search.reference")[0], held)
    cell.search.resume()
    cell.run(200.0)
    assert cell.search.done


def fed(block: ClampSearch, frames: int = 1, **inputs: object) -> list[np.ndarray]:
    """Run a block over samples that are all alike; answers as wanted unless told."""
    given: dict[str, object] = {"angle": POSE, "torque": 0.0, "softened": 1.0, "clamped": 1.0, "fault": 0.0}
    seen = [np.full((frames, port.width), (given | inputs)[port.name]) for port in block.inputs]
    made = [np.zeros((frames, port.width)) for port in block.outputs]
    block.process(*seen, *made)
    return made


def clamped(made: ClampProcedure) -> ClampSearch:
    """Return a block that has just been told that the clamp is closed."""
    block = ClampSearch(made)
    block.prepare(RATE, 1)
    while block.steps[block.step].kind != "check":
        fed(block)
    return block


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"torque": np.array([0, 0, 170.0, 0, 0, 0])}, "torque of joint 3 is beyond its limit of 160 N m"),
        ({"torque": np.array([0, np.nan, 0, 0, 0, 0])}, "angle or torque of joint 2 is not a number"),
        ({"angle": POSE + np.array([0, 0, 0, 0, 0.021, 0])}, "the clamp slips: joint 5 has moved by more than 20 mrad"),
        ({"fault": 1.0}, "robot port is at fault"),
        ({"fault": np.nan}, "robot port is at fault"),
        ({"clamped": 0.0}, "the clamp has opened"),
    ],
)
def test_what_goes_wrong_in_the_clamp_is_named_latches_and_moves_nothing_more(wrong: dict, says: str) -> None:  # type: ignore[type-arg]
    block = clamped(procedure())
    step = block.step
    reference, soft, clamp, joint = fed(block, **wrong)
    assert block.cause is not None
    assert says in block.cause
    after = fed(block, 100)
    np.testing.assert_allclose(after[0][-1], reference[0], atol=1e-12)
    assert (block.step, after[1][-1, 0], after[2][-1, 0], after[3][-1, 0]) == (step, 1.0, 1.0, 0.0)
    assert says in block.cause


def test_after_a_torque_too_large_references_go_back_to_where_there_was_little() -> None:
    block = clamped(procedure())
    before = fed(block)[0][0]
    pushed = fed(block, 50)[0][-1]
    assert pushed[0] - before[0] > 0.009
    fed(block, torque=np.array([250.0, 0, 0, 0, 0, 0]))
    back = fed(block, 200)[0]
    assert np.abs(np.diff(back[:, 0])).max() <= 0.05 / RATE * 1.001
    np.testing.assert_allclose(back[-1], POSE, atol=1e-12)


def test_a_joint_that_meets_no_torque_is_not_pushed_further_than_its_reach() -> None:
    block = clamped(procedure(reach=np.full(6, 0.05)))
    reference = fed(block, 500)[0]
    assert block.cause is not None
    assert "reference of joint 1 is 50 mrad off" in block.cause
    assert np.abs(reference - POSE).max() < 0.0505


def test_a_torque_that_never_falls_ends_the_search() -> None:
    block = clamped(procedure(rounds=3))
    for sign in (1, -1):
        fed(block, 1, torque=sign * limits().proof)
    while block.cause is None:
        fed(block, 1, torque=sign * limits().proof)
    assert "no zero torque was found within 3 rounds" in block.cause


def test_a_clamp_that_does_not_answer_is_not_waited_for_for_ever() -> None:
    block = ClampSearch(procedure())
    block.prepare(RATE, 1)
    fed(block, 3000, clamped=0.0)
    assert block.cause == "step 'clamp' was not answered within 1 s"


def test_a_person_can_abort_and_prepare_begins_anew() -> None:
    block = clamped(procedure())
    block.abort("smoke")
    assert block.cause == "smoke"
    fed(block, 10, torque=1e9)
    assert block.cause == "smoke"
    block.prepare(RATE, 1)
    assert (block.cause, block.step) == (None, 0)


def test_every_motion_is_told_in_words_before_any_is_made() -> None:
    words = [step.words for step in procedure((0, 5)).steps()]
    assert len(words) == 3 + 2 + 1 + 2 + 3
    assert words[0] == "move to the clamping pose (5, 5, -5, 10, 40, 5) deg at 28.6 deg/s"
    assert words[3].startswith("joint 1, clamp check: to +-30 N m and back")
    assert "joint 6, 2 cycles: to +-10 N m" in words[7]
    assert "abort at 20 N m" in words[7]


@pytest.mark.parametrize(
    ("other", "says"),
    [
        ({"speed": np.full(6, np.nan)}, "speed is .*nan.*, must be finite and > 0"),
        ({"softness": np.full(6, 1.0)}, "softness .* must be < 1"),
        ({"turn": np.full(6, 500.0)}, "turn is .* must be < clamping.torque"),
        ({"proof": np.full(6, 190.0)}, "proof is .* must be <= clamping.turn"),
        ({"cycles": 1}, "cycles is 1, must be >= 2"),
        ({"travel": np.full(5, 0.01)}, r"travel has shape \(5,\), must be \(6,\)"),
    ],
)
def test_limits_that_do_not_fit_are_refused(other: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        procedure(**other)  # type: ignore[arg-type]


def test_joints_and_poses_the_arm_has_not_are_refused() -> None:
    arm = irb140()
    with pytest.raises(ValueError, match="joint 7 is not there"):
        ClampProcedure(arm, POSE, HOME, (6,), limits())
    with pytest.raises(ValueError, match="each once"):
        ClampProcedure(arm, POSE, HOME, (1, 1), limits())
    with pytest.raises(ValueError, match="joint 1 is at 291.479 deg"):
        ClampProcedure(arm, POSE + 5.0, HOME, (1,), limits())

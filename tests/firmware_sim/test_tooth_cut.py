"""The cut tooth by tooth against forces worked out by hand, and its chatter against the stability of its equation."""

import numpy as np
import pytest
from scipy.integrate import quad

from firmware_sim.plants.hardness import Hardness
from firmware_sim.plants.tooth_cut import CuttingLaw, ToolMode, ToothCutPlant
from tests.firmware_sim.tooth_runs import DEPTH, LINEAR, RATE, SPINDLE, TOOL, cut, depth_limit, path, run

FEED = 12e-3
KIENZLE = CuttingLaw((7e8, 3e8, 1e8), (0.25, 0.3, 0.2), (0.0, 0.0, 0.0))


def test_kienzles_force_is_the_one_worked_out_by_hand() -> None:
    """k_c1.1 = 700 N/mm^2, m = 0.25, b = 2 mm, h = 0.01 mm: 700 x 2 x 0.01^0.75 = 44.27 N."""
    assert 2e-3 * KIENZLE.force(np.array([1e-5]), 0)[0] == pytest.approx(44.27, rel=1e-3)
    rubbing = CuttingLaw((7e8, 3e8, 1e8), (0.25, 0.3, 0.2), (5e3, 0.0, 0.0))
    assert 2e-3 * rubbing.force(np.array([1e-5]), 0)[0] == pytest.approx(44.27 + 10.0, rel=1e-3)
    assert LINEAR.force(np.array([0.0, 2e-5, 4e-5]), 1) == pytest.approx([0.0, 4e3, 8e3])


def slot_force(law: CuttingLaw, feed: float, teeth: int) -> np.ndarray:
    """Return the mean force in a slot over a turn, along the feed and to its left, N, by the integral over a tooth."""
    chip = feed / (teeth * SPINDLE)

    def part(angle: float, to_left: bool) -> float:
        x, y = np.cos(angle), np.sin(angle)
        tangential, radial = (float(law.force(np.array([chip * x]), way)[0]) for way in range(2))
        return tangential * x - radial * y if to_left else -tangential * y - radial * x

    sides = [quad(part, -np.pi / 2, np.pi / 2, args=(side,), limit=200)[0] for side in (False, True)]
    return np.array(sides) * DEPTH * teeth / (2 * np.pi)


@pytest.mark.parametrize("law", [LINEAR, KIENZLE, CuttingLaw((6e8, 2e8, 1e8), (0.0,) * 3, (2e4, 1e4, 0.0))])
@pytest.mark.parametrize("teeth", [1, 2, 3])
def test_a_slots_mean_force_is_the_integral_of_its_law(law: CuttingLaw, teeth: int) -> None:
    found = run(cut(law=law, wobble=(0.0,) * teeth), path((FEED, 0.0), 0.6))
    mean = found["teeth_force"][600:].mean(axis=0)
    np.testing.assert_allclose(mean[:2], slot_force(law, FEED, teeth), rtol=0.03, atol=0.02 * np.abs(mean[:2]).max())


def test_kappa_and_beta_are_what_the_force_comes_to() -> None:
    found = run(cut(), path((0.0, FEED), 0.6))
    along, left = slot_force(LINEAR, FEED, 2)
    assert found["kappa"][-1, 0] == pytest.approx(FEED / -along, rel=0.02)
    assert found["beta"][-1, 0] == pytest.approx(left / -along, rel=0.02)


def test_air_costs_nothing_and_a_second_pass_less() -> None:
    assert not run(cut(), path((FEED, 0.0), 0.2, -1e-3))["force"].any()
    there = path((FEED, 0.0), 0.6)
    twice = np.concatenate([there, there[::-1]])
    found = np.abs(run(cut(), twice)["teeth_force"][:, :2]).mean(axis=1)
    assert found[1_600:2_300].mean() < 0.02 * found[500:1_100].mean()


def test_teeth_show_as_they_pass_and_one_that_stands_out_once_a_turn() -> None:
    lines = {}
    for wobble in ((0.0, 0.0), (10e-6, -10e-6)):
        found = run(cut(wobble=wobble), path((FEED, 0.0), 1.1))
        spectrum = np.abs(np.fft.rfft(found["teeth_force"][200:2_200, 0] * np.hanning(2_000))) / 500
        lines[wobble] = [spectrum[round(each)] for each in (SPINDLE, 2 * SPINDLE)]
        told = run(cut(wobble=wobble, is_averaged=True), path((FEED, 0.0), 1.1))["teeth_force"][400:, 0]
        assert told.std() < 0.1 * abs(told.mean())
    assert lines[(0.0, 0.0)][1] > 3.0
    assert lines[(0.0, 0.0)][0] < 0.05 * lines[(0.0, 0.0)][1]
    assert lines[(10e-6, -10e-6)][0] > 1.0


def test_hard_boards_push_by_as_much_more() -> None:
    boards = Hardness(boards=(0.5, 4.0))
    found = run(cut(hardness=boards), path((FEED, 0.0), 1.2))["teeth_force"]
    soft, hard = (np.linalg.norm(found[part, :2].mean(axis=0)) for part in (slice(200, 500), slice(1_900, 2_300)))
    assert hard / soft == pytest.approx(8.0, rel=0.02)


def test_a_robot_that_gives_way_is_pulled_by_the_mean_of_the_teeth() -> None:
    """Its tip goes where force and compliance have it; nothing shakes, however soft it is."""
    give, wood = np.zeros((1_600, 9)), CuttingLaw((1e8, 4e7, 1e7), (0.0,) * 3, (0.0,) * 3)
    give[:, [0, 4, 8]] = 9e-6
    tool, told = path((FEED, 0.0), 0.8), np.zeros(3)
    made = cut(law=wood, mass=8.0)
    plant, outputs = ToothCutPlant(RATE, made), [np.zeros((1_600, width)) for width in (3, 3, 3, 1, 1)]
    for n in range(1_600):
        now = slice(n, n + 1)
        plant.run(tool[now] + 9e-6 * told, give[now], *(each[now] for each in outputs))
        told = outputs[0][n]
    force, teeth = outputs[0][800:], outputs[2][800:]
    np.testing.assert_allclose(force.mean(axis=0)[:2], slot_force(wood, FEED, 2), rtol=0.03)
    np.testing.assert_allclose(force.mean(axis=0), teeth.mean(axis=0), rtol=0.03, atol=0.01)
    assert force[:, 0].std() < 0.2 * teeth[:, 0].std()


@pytest.mark.sample(2)
@pytest.mark.parametrize(("along", "turn"), [(True, 28), (True, 16), (False, 17), (False, 15)])
def test_it_chatters_beyond_the_depth_at_which_its_equation_is_unstable(along: bool, turn: int) -> None:
    """Where the stability lobes of a tool with one degree of freedom have it: between 0.85 and 1.2 of that."""
    mode, still, spindle = (400.0, 0.01, 2e6), 1e13, RATE / turn
    limit = depth_limit(mode, spindle, along)
    stiffness = (mode[2], still) if along else (still, mode[2])
    rings = []
    for share in (0.85, 1.2):
        made = cut(mode=ToolMode((mode[0],) * 2, (mode[1],) * 2, stiffness), spindle=spindle, layer=2e-4)
        found = run(made, path((2 * spindle * 50e-6, 0.0), 1.5, share * limit))["ringing"][:, 0 if along else 1]
        rings.append((found[-800:] - found[-800 - 10 * turn : -10 * turn]).std() / np.abs(found[-800:]).max())
    assert rings[0] < 0.02, (limit, rings)
    assert rings[1] > 0.05, (limit, rings)


def test_a_faster_spindle_may_cut_deeper() -> None:
    """The pocket between two lobes: at 167 Hz the tool is quiet where at 111 Hz it chatters six times less deep."""
    limit = depth_limit((400.0, 0.01, 2e6), RATE / 18, True)
    made = cut(mode=ToolMode((400.0, 400.0), (0.01, 0.01), (2e6, 1e13)), spindle=RATE / 12, layer=2e-4)
    found = run(made, path((2 * RATE / 12 * 50e-6, 0.0), 1.0, 6 * limit))["ringing"][:, 0]
    assert (found[-400:] - found[-520:-120]).std() < 0.02 * np.abs(found[-400:]).max()


def test_chatter_stays_within_what_teeth_that_leave_the_wave_allow() -> None:
    mode = ToolMode((400.0, 400.0), (0.03, 0.03), (2e6, 2e6))
    found = run(cut(mode=mode, spindle=115.0), path((FEED, 0.0), 1.0, 1.5e-3))["ringing"]
    assert 20e-6 < np.abs(found).max() < TOOL / 4


def test_what_chatters_most_is_finite_still() -> None:
    """Forces that are larger than the tool is stiff, and no tooth that takes more than its gullet holds."""
    mode = ToolMode((400.0, 400.0), (0.01, 0.01), (1e6, 1e6))
    found = run(cut(mode=mode, spindle=115.0), path((FEED, 0.0), 1.0, 5e-3))
    assert all(np.isfinite(each).all() for each in found.values())
    assert np.abs(found["teeth_force"]).max() < 2 * 6e8 * 0.6e-3 * 5e-3 * 2

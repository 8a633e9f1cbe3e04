"""The simulated cut in a block: forces against closed forms, what is left of the block, and a tool that gives way."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.plants.cutting_force import MATERIALS
from firmware_sim.plants.milling import PocketMilling

RATE, FEED, RADIUS, TEETH, SPINDLE = 2_000.0, 10e-3, 3e-3, 2, 22_000 / 60
CHIP = FEED / (TEETH * SPINDLE)
SIDE = 15e-3


def block(**options: Any) -> PocketMilling:
    return PocketMilling(
        options.pop("rate", RATE), spread=0.0, **({"length": 2 * SIDE, "width": 2 * SIDE, "runout": 0.0} | options)
    )


def mill(cut: PocketMilling, path: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    force, moment, teeth_force = np.empty((3, *path.shape))
    cut.run(path, np.zeros((len(path), 9)), force, moment, teeth_force)
    return force, moment, teeth_force


def along(start: tuple[float, float, float], stop: tuple[float, float, float], speed: float = FEED) -> np.ndarray:
    way = np.subtract(stop, start)
    samples = round(np.linalg.norm(way) / speed * RATE)
    return np.array(start) + np.arange(1, samples + 1)[:, None] / samples * way


def mean_force(begin: float, end: float, depth: float, material: str = "al7075") -> np.ndarray:
    """Return what a tool fed along x feels on average, N; angles (rad) turn with it, from +y.

    Altintas, Manufacturing Automation, 2nd ed., (2.8): forces of the workpiece on the tool.
    """
    (ktc, krc, kac), (kte, kre, kae) = MATERIALS[material].cutting, MATERIALS[material].edge

    def upto(angle: float) -> np.ndarray:
        c, s, c2, s2 = np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)
        turns = TEETH * depth / (2 * np.pi)
        return turns * np.array([
            CHIP / 4 * (ktc * c2 - krc * (2 * angle - s2)) + (-kte * s + kre * c),
            CHIP / 4 * (ktc * (2 * angle - s2) + krc * c2) - (kte * c + kre * s),
            kac * CHIP * c - kae * angle,
        ])  # fmt: skip

    return upto(end) - upto(begin)


@pytest.mark.parametrize(
    ("material", "depth"), [("al7075", 2e-3), ("al7075", 4e-3), ("al7075-hss", 2e-3), ("al6082", 2e-3)]
)
def test_a_slots_mean_force_is_altintas(material: str, depth: float) -> None:
    force, moment, teeth_force = mill(block(material=material), along((-SIDE - RADIUS, 0, -depth), (0, 0, -depth)))
    wanted, steady = mean_force(0.0, np.pi, depth, material), slice(-1_000, None)
    np.testing.assert_allclose(force[steady].mean(axis=0), wanted, rtol=0.02)
    np.testing.assert_allclose(teeth_force[steady].mean(axis=0), wanted, rtol=0.05)
    (ktc, _, _), (kte, _, _) = MATERIALS[material].cutting, MATERIALS[material].edge
    torque = TEETH * depth * RADIUS * (ktc * CHIP / np.pi + kte / 2)
    assert moment[steady, 2].mean() == pytest.approx(torque, rel=0.06)


@pytest.mark.parametrize("width", [1.5e-3, 0.2e-3])
@pytest.mark.parametrize("hand", ["up", "down"])
def test_a_side_cuts_mean_force_follows_its_width_up_and_down(hand: str, width: float) -> None:
    """Also for a finishing cut of two cells: walls are known far better than the grid is wide."""
    reach = np.arccos(1.0 - width / RADIUS)
    side = 1.0 if hand == "up" else -1.0  # of the material, seen along the feed
    offset = side * -(SIDE + RADIUS - width)
    force, _, _ = mill(block(), along((-SIDE - RADIUS, offset, -2e-3), (-8e-3, offset, -2e-3)))
    limits = (0.0, reach) if hand == "up" else (np.pi - reach, np.pi)
    np.testing.assert_allclose(force[-400:].mean(axis=0), mean_force(*limits, 2e-3), rtol=0.05, atol=0.5)


def test_chips_and_what_is_gone_are_the_swept_volume() -> None:
    cut = block()
    mill(cut, along((-SIDE - RADIUS, 0, -2e-3), (0, 0, -2e-3)))
    swept = 2e-3 * (2 * RADIUS * SIDE + 0.5 * np.pi * RADIUS**2)
    assert cut.chips == pytest.approx(swept, rel=0.01)
    assert cut.taken == pytest.approx(swept, rel=0.01)
    x, y, distance = cut.section(1e-3)
    half = (y > 0) & (y < 6e-3)
    wall = np.interp(0.0, distance[half, np.argmin(np.abs(x + 8e-3))], y[half])
    assert wall == pytest.approx(RADIUS, abs=0.5e-6)


def test_there_is_no_force_in_the_air_nor_where_the_block_is_cut_already() -> None:
    cut = block()
    out, back = along((-12e-3, 0, -2e-3), (0, 0, -2e-3)), along((0, 0, -2e-3), (-12e-3, 0, -2e-3))
    above = mill(cut, along((-12e-3, 0, 1e-4), (0, 0, 1e-4), 50e-3))[0]
    beside = mill(cut, along((-19e-3, -12e-3, -2e-3), (-19e-3, 12e-3, -2e-3), 50e-3))[0]
    assert np.abs(above).max() == np.abs(beside).max() == 0.0
    first = mill(cut, out)[0][-1_000:]
    again = mill(cut, back)[0][100:-300]  # the last tenth of a millimetre is taken when the tool leaves it
    assert np.linalg.norm(again, axis=1).max() < 0.01 * np.linalg.norm(first.mean(axis=0))


def test_deeper_layers_are_cut_after_higher_ones() -> None:
    cut = block()
    forces = []
    for depth in (2e-3, 4e-3):
        forces.append(mill(cut, along((-SIDE - RADIUS, 0, -depth), (0, 0, -depth)))[0][-800:].mean(axis=0))
        mill(cut, along((0, 0, 1e-3), (-SIDE - RADIUS, 0, 1e-3), 0.1))
    np.testing.assert_allclose(forces[1], forces[0], rtol=0.02)


def test_a_steep_descent_is_felt_below_and_a_gentle_ramp_is_not() -> None:
    (_, krc, _), (_, kre, _) = MATERIALS["al7075"].cutting, MATERIALS["al7075"].edge
    plunge = mill(block(), along((0, 0, 1e-3), (0, 0, -3e-3), 4e-3))[0]
    chip = 4e-3 / (TEETH * SPINDLE)
    assert plunge[-600:, 2].mean() == pytest.approx(TEETH * RADIUS * (krc * chip + kre), rel=0.02)
    ramp = mill(block(), along((-10e-3, 0, 0.0), (0, 0, -0.3e-3)))[0]  # 1.7 degrees
    assert ramp[:, 2].max() == 0.0


def test_the_teeth_are_heard_and_runout_brings_the_spindle_in() -> None:
    rate = 10_000.0
    for runout, least in ((0.0, 0.0), (4e-6, 0.1)):
        time = np.arange(10_000) / rate
        path = np.column_stack([-6e-3 + FEED * time, np.zeros(10_000), np.full(10_000, -2e-3)])
        mill_cut = block(rate=rate, runout=runout)
        force = mill(mill_cut, path)[2][-6_000:, 1]
        lines = np.abs(np.fft.rfft(force * np.hanning(6_000))) / 1_500
        at = {name: lines[round(f / rate * 6_000)] for name, f in (("teeth", TEETH * SPINDLE), ("spindle", SPINDLE))}
        assert at["teeth"] > 0.3 * force.mean()
        assert least * force.mean() <= at["spindle"]
        assert runout > 0.0 or at["spindle"] < 0.01 * force.mean()


def springy(cut: PocketMilling, path: np.ndarray, at_once: float = 2e-6) -> tuple[np.ndarray, np.ndarray]:
    """Mill with a tool that gives way, m/N: by `at_once` after a sample, as across a joint, by 8e-6 more in 20 ms."""
    forces, places, yielded = np.zeros((len(path) + 1, 3)), np.zeros_like(path), np.zeros(3)
    moment, teeth_force = np.zeros((2, 1, 3))
    share = 1.0 / (20e-3 * RATE)
    give = (at_once + 8e-6 * share) * np.eye(3).reshape(1, 9)
    for n in range(len(path)):
        yielded += share * (8e-6 * forces[n] - yielded)
        places[n] = path[n] + yielded + at_once * forces[n]
        cut.run(places[n : n + 1], give, forces[n + 1 : n + 2], moment, teeth_force)
    return places, forces[1:]


def test_a_tool_that_gives_way_takes_less_and_a_second_pass_takes_the_rest() -> None:
    cut, offset, last = block(), SIDE + RADIUS - 0.5e-3, slice(-800, None)  # down milling pushes it away from the wall
    path = along((-SIDE - RADIUS, offset, -2e-3), (-5e-3, offset, -2e-3))
    places, forces = springy(cut, path)
    away, push = (places - path)[last, 1].mean(), forces[last, 1].mean()
    assert away == pytest.approx(10e-6 * push, rel=0.01)
    assert 0.0 < push < 0.95 * mill(block(), path)[0][last, 1].mean()
    x, y, distance = cut.section(1e-3)
    outside = (y < 16e-3) & (y > 14e-3)
    wall = np.interp(0.0, -distance[outside, np.argmin(np.abs(x + 7e-3))], y[outside])
    assert wall == pytest.approx(places[last, 1].mean() - RADIUS, abs=1e-6)
    again = springy(cut, path)
    assert 0.0 < again[1][last, 1].mean() < 0.8 * push
    assert 0.0 < (again[0] - path)[last, 1].mean() < 0.8 * away


def plunge_and_slot(depth: float) -> np.ndarray:
    return np.vstack([along((0, 0, 1e-3), (0, 0, -depth), 2e-3), along((0, 0, -depth), (5e-3, 0, -depth))])


@pytest.mark.sample(3)
@pytest.mark.parametrize("at_once", [0.0, 2e-6, 3.2e-6, 2e-5])
@pytest.mark.parametrize("depth", [2e-3, 4e-3])
def test_a_tool_that_gives_way_at_once_does_not_shake(depth: float, at_once: float) -> None:
    """Guards the exchange with a robot, where what tilts has no mass: by 3 um/N, and any other option's size."""
    forces = springy(block(), plunge_and_slot(depth), at_once)[1][-800:]
    assert np.abs(np.diff(forces, axis=0)).max() < 0.01 * np.linalg.norm(forces.mean(axis=0))


def test_a_tool_that_gives_way_feels_what_one_on_rails_feels_on_the_same_way() -> None:
    """Guards against a lag: a tool's own speed has in it already how it gives way."""
    places, forces = springy(block(), plunge_and_slot(2e-3), 3e-6)
    on_rails = mill(block(), places)[0]
    assert np.linalg.norm(forces, axis=1).max() > 50.0
    assert np.sqrt(np.mean((forces - on_rails)[1_100:] ** 2)) < 1.0  # from where it has touched


def test_blocks_differ_by_their_seed_and_a_worn_tool_rubs_more() -> None:
    path = along((-8e-3, 0, -2e-3), (-6e-3, 0, -2e-3))
    sizes = [np.linalg.norm(mill(PocketMilling(RATE, seed=seed), path)[0][-1]) for seed in range(6)]
    assert 0.005 < np.std(sizes) / np.mean(sizes) < 0.06
    sharp, worn = mill(block(), path)[0][-1], mill(block(wear=1.5), path)[0][-1]
    assert worn[0] == pytest.approx(sharp[0] + 0.5 * -TEETH * 2e-3 * MATERIALS["al7075"].edge[1] / np.pi, rel=0.03)


def test_a_wrong_option_is_refused_by_name() -> None:
    with pytest.raises(
        ValueError, match="simulator.options.material is 'butter', must be 'al7075' or 'al7075-hss' or 'al6082'"
    ):
        block(material="butter")
    with pytest.raises(ValueError, match="the block has 1e\\+08 points"):
        block(length=0.1, width=0.1, thickness=0.01, cell=5e-5, layer=4e-4)
    with pytest.raises(ValueError, match="rate is 200"):
        PocketMilling(200.0)

"""Trials on the simulated cell: they come to their end, or out of the material; runs differ by their noise alone."""

from dataclasses import replace

import numpy as np
import pytest

from rigkit.experiment.runner import STOPPED, Conduct, repeated
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.recorded import SLOW
from stagectl.experiments.trials.signals import touched_block, touched_off
from stagectl.experiments.trials.surroundings import recorded
from stagectl.experiments.trials.trial import Trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.link.tell import nobody
from tests.stagectl.experiments.trials.short_trial import Ran, ran, small


@pytest.fixture(scope="module")
def first() -> Trial:
    return small()


@pytest.fixture(scope="module")
def air(first: Trial) -> Ran:
    return ran(first)


@pytest.fixture(scope="module")
def touched(first: Trial, air: Ran) -> Trial:
    return replace(first, zero=touched_off(first, air.recordings), block=touched_block(first, air.recordings))


def test_a_trial_in_the_air_follows_its_path_and_feels_nothing(touched: Trial, air: Ran) -> None:
    done = DoneTrial("free-0", touched, air.recordings)
    assert air.reason == ""
    assert np.abs(air.recordings["truth"].select(["force_x"]).data).max() == 0.0
    assert np.linalg.norm(done.mae) < 300e-6
    force = done.signals.force
    assert force is not None
    assert np.abs(force[touched.path.milled].mean(axis=0)).max() < 0.1  # the sensor's bias, of 5 N, is not left in it
    assert done.true_mae is not None
    assert np.linalg.norm(done.true_mae) < np.linalg.norm(done.mae)


@pytest.mark.slow
def test_a_trial_in_material_feels_it_and_is_pushed_aside(touched: Trial, air: Ran) -> None:
    trial = touched.again(touched.sent, True)
    done, before = DoneTrial("milled-0", trial, ran(trial).recordings), DoneTrial("free-0", touched, air.recordings)
    force = done.signals.force
    assert force is not None
    assert 2.0 < np.abs(force[touched.path.milled]).mean(axis=0).max() < 100.0
    assert np.linalg.norm(done.mae) > np.linalg.norm(before.mae)


@pytest.mark.slow
def test_another_trial_has_other_noise_on_the_same_machine(first: Trial, air: Ran) -> None:
    other = ran(replace(first, number=1))
    for name, columns in (("tracker", ["tool_seen_x"]), ("trial", ["torque_2"])):
        here, there = (each.recordings[name].select(columns).data for each in (air, other))
        assert not np.array_equal(here, there)
    here, there = (each.recordings["truth"].select(["position_x"]).data for each in (air, other))
    assert there == pytest.approx(here, abs=2e-5)


def test_a_blind_tracker_lifts_the_tool_out(touched: Trial) -> None:
    blind = small("plants.tracker_options.blind=4.0", "plants.tracker_options.blind_for=9.0")
    done = ran(replace(touched.again(touched.sent, True), cell=blind.cell))
    assert done.reason.startswith("the tracker is blind for 0.05")
    assert touched.block is not None
    height = done.recordings["truth"].select(["position_z"]).data[:, 0] - touched.block[2]
    assert height[1000] < -1e-4  # at 4 s it was in the material
    assert height[-1] == pytest.approx(touched.path.pocket.clearance, abs=2e-4)
    assert len(height) < 6.5 * 250


def test_a_silent_robot_is_held_where_it_is(first: Trial) -> None:
    done = ran(replace(first, cell=small("plants.robot_options.mute=2.0").cell))
    assert done.reason.startswith("the robot is silent for")
    asked = done.recordings["trial"].select(["reference_2"]).data[-50:, 0]
    assert np.ptp(asked) < 1e-9


def test_a_correction_beyond_the_limit_never_reaches_the_robot(first: Trial) -> None:
    done = ran(replace(first, sent=first.sent + [0.0, 0.0, 3.2e-3]))
    assert done.reason.startswith("the correction moves the tool by 3.2 mm, must be <= 3 mm")


@pytest.mark.parametrize("seconds", [0.1, 0.4, 1.5])
def test_a_trial_that_its_user_stops_is_made_again_bit_for_bit(touched: Trial, seconds: float) -> None:
    """Also one that is stopped before the robot follows, or just then."""
    told = [0.0]
    conduct = Conduct(lambda: told[0] >= seconds, show=lambda done: told.__setitem__(0, done))
    records, reason = ran(touched, conduct)
    assert reason == STOPPED
    done = DoneTrial("one", touched, records)
    part = TrialGraph("one", touched, nobody, recorded(records)).part_again(done.left)
    again = repeated(part, SLOW * len(records["trial"].data))
    for track in part.tracks:
        names = track.made_names(part.graph)
        before = records[track.name.removeprefix("one-")].select(names).data
        assert again[track.name].select(names).data.tobytes() == before.tobytes()

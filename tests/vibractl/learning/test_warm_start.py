"""The check of a known drive: how it is scaled, what it accepts, and what it refuses before it is loud."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.law import Law
from vibractl.learning.shot import Shot
from vibractl.learning.warm_start import Check, KnownDrive

LEVELS = (-12.0, -6.0, 0.0)
DISTORTION = 0.2
"""Of a weak line re a strong one: 26 dB over the limit."""


@pytest.fixture(scope="module", params=["kalman", "thesis"])
def law(request: pytest.FixtureRequest) -> Law:
    return law_of(matrix_of(modal(2, 2)), law=request.param)


def learned(law: Law, plant: LinePlant) -> KnownDrive:
    """Return what thirty shots learn on a plant, checked at all three levels."""
    algorithm = algorithm_of(law)
    for _ in range(30):
        shot = plant.shot(algorithm.lines)
        algorithm.step(shot)
    judged = law.matrix.frequency >= 100
    return KnownDrive("known", shot.drive, shot.response, algorithm.belief.response, judged, LEVELS)


def algorithm_of(law: Law, known: KnownDrive | None = None) -> Algorithm:
    return Algorithm(law, Adaptation(), Watch(), -40.0, known)


@pytest.fixture(scope="module")
def known(law: Law) -> KnownDrive:
    return learned(law, LinePlant(modal(2, 2), law, distortion=DISTORTION))


def stepped(algorithm: Algorithm, plant: LinePlant, count: int) -> list[Shot]:
    shots = []
    for _ in range(count):
        shots.append(plant.shot(algorithm.lines))
        algorithm.step(shots[-1])
    return shots


def test_strong_lines_are_scaled_by_the_level_and_others_by_its_square(law: Law, known: KnownDrive) -> None:
    check = Check(known, law.reference, 0.01)
    frequency, level = law.matrix.frequency, 10 ** (-12 / 20)
    strong, weak = np.argmin(np.abs(frequency - 65)), np.argmin(np.abs(frequency - 130))
    np.testing.assert_allclose(check.drive[strong], level * known.drive[strong])
    np.testing.assert_allclose(check.drive[weak], level**2 * known.drive[weak])
    check.take(known.response)
    check.take(known.response)
    np.testing.assert_array_equal(check.drive, known.drive)


def test_on_the_same_machine_it_is_accepted_and_learned_from_at_full_level_only(law: Law, known: KnownDrive) -> None:
    algorithm, plant = algorithm_of(law, known), LinePlant(modal(2, 2), law, distortion=DISTORTION)
    model = algorithm.belief.response.copy()
    levels, purposes = [], []
    for level in LEVELS:
        levels.append(20 * np.log10(algorithm.level))
        purposes.append(algorithm.purpose)
        np.testing.assert_array_equal(algorithm.belief.response, model)
        assert algorithm.decisions == []
        (shot,) = stepped(algorithm, plant, 1)
        if level < 0:
            assert np.abs(shot.drive).max() < 0.51 * np.abs(known.drive).max()
    np.testing.assert_allclose(levels, LEVELS, atol=1e-9)
    assert purposes == ["check"] * 3
    (accepted,) = algorithm.decisions
    assert accepted.event == "library_accepted"
    assert accepted.fields["entry"] == "known"
    assert accepted.fields["worst_db"] < 0
    assert algorithm.daring.nominal == law.gains.gains[-1]  # met already: no haste
    assert algorithm.purpose == "learn"
    assert algorithm.level == 1.0
    assert np.abs(law.reference - stepped(algorithm, plant, 1)[0].response).max() < 0.02 * np.abs(law.reference).max()


def test_where_the_objective_is_not_met_at_once_it_learns_with_the_first_gain(law: Law, known: KnownDrive) -> None:
    algorithm = algorithm_of(law, known)
    stepped(algorithm, LinePlant(modal(2, 2), law, distortion=1.15 * DISTORTION), 3)
    (accepted,) = algorithm.decisions
    assert accepted.event == "library_accepted"
    assert accepted.fields["worst_db"] > 0
    assert algorithm.daring.nominal == law.gains.gains[0]


@pytest.mark.parametrize(
    ("response", "decided_by"),
    [
        (-modal(2, 2), "off"),  # wrong polarity
        (2.0 * modal(2, 2), "off"),  # another amplifier
        (np.where(np.arange(len(modal(2, 2)))[:, None, None] > 100, 6.0, 1.0) * modal(2, 2), "error"),
    ],
)
def test_another_machine_is_refused_at_the_first_level_and_the_run_starts_as_without_it(
    law: Law, known: KnownDrive, response: np.ndarray, decided_by: str
) -> None:
    algorithm, plant = algorithm_of(law, known), LinePlant(response, law, distortion=DISTORTION)
    (shot,) = stepped(algorithm, plant, 1)
    (refused,) = algorithm.decisions
    assert refused.event == "library_refused"
    assert refused.fields["level_db"] == -12
    assert refused.fields[decided_by] > (0.5 if decided_by == "off" else 1.0)
    np.testing.assert_array_equal(algorithm.lines, law.start)
    assert np.abs(shot.drive).max() < 0.26 * np.abs(known.drive).max()
    plain = algorithm_of(law)
    np.testing.assert_array_equal(plain.lines, algorithm.lines)
    shot = plant.shot(algorithm.lines)
    for each in (plain, algorithm):
        each.step(shot)
    np.testing.assert_array_equal(plain.lines, algorithm.lines)


def test_a_machine_that_hardly_distorts_may_err_by_as_much_as_the_objective_allows(law: Law) -> None:
    plant = LinePlant(modal(2, 2), law)
    known = learned(law, plant)
    algorithm = algorithm_of(law, known)
    stepped(algorithm, plant, 3)
    assert [each.event for each in algorithm.decisions] == ["library_accepted"]
    loud = algorithm_of(law, known)
    stepped(loud, LinePlant(modal(2, 2), law, distortion=1.0), 1)
    assert [each.event for each in loud.decisions] == ["library_refused"]


def test_a_response_that_is_not_a_number_is_refused(law: Law, known: KnownDrive) -> None:
    check = Check(known, law.reference, 0.01)
    assert not check.take(np.full(law.reference.shape, np.nan)).accepted
    none_judged = replace(known, judged=np.zeros(len(law.reference), bool))
    assert not Check(none_judged, law.reference, 0.01).take(np.full(law.reference.shape, np.nan)).accepted


def test_from_the_start_again_it_checks_again(law: Law, known: KnownDrive) -> None:
    algorithm, plant = algorithm_of(law, known), LinePlant(modal(2, 2), law, distortion=DISTORTION)
    first = algorithm.lines.copy()
    stepped(algorithm, plant, 4)
    algorithm.restart()
    assert algorithm.purpose == "check"
    np.testing.assert_array_equal(algorithm.lines, first)

"""What a run's learning stands on, from its settings and the model."""

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import FREQUENCY, law_of, matrix_of, modal
from vibractl.learning.gains import CHIRP_GAINS, KALMAN_GAINS, SINE_GAINS
from vibractl.learning.law import reference_level
from vibractl.learning.law_of_run import settled_window
from vibractl.learning.laws import SIGNIFICANT
from vibractl.reference import reference_from
from vibractl.transfer_matrix import norm, regularized_inverse

MODEL = matrix_of(modal(2, 2))


def test_decentralised_learning_that_follows_g_is_refused() -> None:
    with pytest.raises(ValueError, match=r"structure is decentralised: learning\.law is kalman, must be thesis"):
        law_of(MODEL, structure="decentralised")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"side": 3}, r"learning\.side is 3, must be 0 to 2"),
        ({"stages": (4,)}, r"learning\.stages is \[4\], but learning\.gains is empty"),
        ({"gains": (0.5, 0.3)}, "0 stages for 2 gains, must have one fewer"),
        ({"band": (15.0, 700.0)}, "15 to 700 Hz are wanted, the model was measured from 14 to 651 Hz"),
    ],
)
def test_settings_that_do_not_fit_are_refused(settings: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        law_of(MODEL, **settings)


@pytest.mark.parametrize(
    ("settings", "reference", "gains"),
    [
        ({}, "chirp:40:90:1", KALMAN_GAINS),
        ({}, "sine:24:1", KALMAN_GAINS),
        ({"law": "thesis"}, "chirp:40:90:1", CHIRP_GAINS),
        ({"law": "thesis"}, "sine:24:1", SINE_GAINS),
    ],
)
def test_each_law_has_its_own_gains(settings: dict[str, object], reference: str, gains: object) -> None:
    assert law_of(MODEL, reference, **settings).gains == gains


def test_the_default_law_starts_from_the_model_and_the_thesis_from_the_reference() -> None:
    law = law_of(MODEL)
    answer = (law.matrix.response @ law.start[..., None])[..., 0]
    strong = np.abs(law.reference[:, 0]) > SIGNIFICANT * np.abs(law.reference).max()
    np.testing.assert_allclose(answer[strong], law.reference[strong], rtol=0.1)
    thesis = law_of(MODEL, law="thesis")
    ratio = thesis.start / thesis.reference
    np.testing.assert_allclose(ratio, np.broadcast_to(ratio[:1], ratio.shape), rtol=1e-9)
    np.testing.assert_array_equal(law_of(MODEL, law="thesis", start="inverse").start, law.start)


def test_the_inverse_is_bounded_line_by_line_or_by_one_number() -> None:
    by_line, by_one = law_of(MODEL), law_of(MODEL, regularisation="constant", constant_epsilon=0.3)
    response = by_one.matrix.response
    np.testing.assert_array_equal(by_one.inverse, regularized_inverse(response, 0.3))
    assert norm(by_one.inverse).max() <= 0.5 / np.sqrt(0.3)
    assert np.all(norm(by_line.inverse) <= 0.5 / np.sqrt(1e-3) / norm(response) * (1 + 1e-9))


def test_one_side_is_one_row_and_one_column() -> None:
    law = law_of(MODEL, side=2)
    first = np.searchsorted(FREQUENCY, law.matrix.frequency[0])
    lines = slice(first, first + len(law.matrix.frequency))
    np.testing.assert_allclose(law.matrix.response[:, 0, 0], MODEL.response[lines, 1, 1], rtol=1e-9)
    np.testing.assert_array_equal(law.spread, [[0.0], [1.0]])
    assert law.outputs == (1,)
    np.testing.assert_array_equal(law_of(matrix_of(modal(3, 3)), side=3).spread, [[0.0], [0.0], [1.0]])


def test_a_drive_for_both_sides_is_one_input_that_drives_every_coil() -> None:
    law = law_of(MODEL, law="thesis", structure="common")
    assert law.matrix.response.shape[1:] == (2, 1)
    np.testing.assert_array_equal(law.spread, np.ones((2, 1)))
    np.testing.assert_allclose(law.matrix.response[..., 0], MODEL.at(law.matrix.frequency).response.sum(axis=2))


def test_of_a_sine_the_root_and_its_overtones_are_learned_and_nothing_else() -> None:
    law = law_of(MODEL, "sine:24:1", overtones=3)
    learned = law.matrix.frequency[law.active > 0]
    np.testing.assert_allclose(learned, [24.0, 48.0, 72.0, 96.0])
    assert np.all(law.start[law.active == 0] == 0)
    longer = law_of(MODEL, "sine:24:2", overtones=3)  # lines half as far apart
    np.testing.assert_allclose(longer.matrix.frequency[longer.active > 0], [24.0, 48.0, 72.0, 96.0])


def test_a_sine_is_wanted_as_large_as_its_steady_state_for_the_whole_shot() -> None:
    law = law_of(MODEL, "sine:24:1")
    wanted = np.abs(law.reference[np.searchsorted(law.matrix.frequency, 24.0)])
    np.testing.assert_allclose(wanted, 10.0 / 2, rtol=1e-3)


def test_the_level_of_a_reference_is_that_of_its_strong_lines() -> None:
    lines = np.array([[4.0, 0.1], [3.0, 2.0], [0.5, 2.0]]) + 0j
    np.testing.assert_allclose(reference_level(lines), [np.sqrt(12.5), 2.0])
    np.testing.assert_allclose(reference_level(10 * lines), [10 * np.sqrt(12.5), 20.0])


def test_weights_make_the_weighted_error_small() -> None:
    """(G^H W^2 G + eps I)^-1 G^H W^2, with eps of W G."""
    weighted = law_of(MODEL, weights=(3.0, 0.5), regularisation="constant", constant_epsilon=0.3)
    response, square = weighted.matrix.response, np.diag([9.0, 0.25])
    adjoint = response.conj().swapaxes(-1, -2)
    expected = np.linalg.solve(adjoint @ square @ response + 0.3 * np.eye(2), adjoint @ square)
    np.testing.assert_allclose(weighted.inverse, expected, rtol=1e-9)
    afar = law_of(MODEL, weights=(3.0, 0.5), sensors="far-field", regularisation="constant", constant_epsilon=0.3)
    np.testing.assert_array_equal(afar.inverse, regularized_inverse(response, 0.3))  # those are weighted elsewhere


def test_of_one_side_the_weight_is_its_own() -> None:
    alone = law_of(MODEL, side=2, weights=(3.0, 0.5), regularisation="constant", constant_epsilon=0.3)
    response = alone.matrix.response
    np.testing.assert_allclose(alone.inverse, regularized_inverse(0.5 * response, 0.3) * 0.5, rtol=1e-9)


def test_decentralised_learning_knows_each_side_s_own_response_and_no_other() -> None:
    law = law_of(MODEL, law="thesis", structure="decentralised")
    whole = MODEL.at(law.matrix.frequency).response
    np.testing.assert_allclose(law.matrix.response, whole * np.eye(2), rtol=1e-9)


def test_the_reference_is_scaled_by_the_plant_s_size_where_the_reference_is_strong() -> None:
    law = law_of(MODEL, law="thesis")
    size = np.abs(law.reference).max(axis=1)
    strong = size > SIGNIFICANT * size.max()
    assert 0 < strong.sum() < len(strong)
    typical = np.median(np.linalg.norm(law.matrix.response[strong], axis=1), axis=0)
    np.testing.assert_allclose(law.start, law.reference / typical, rtol=1e-9)


def test_one_drive_for_both_sides_begins_with_the_mean_of_the_references() -> None:
    law = law_of(MODEL, law="thesis", structure="common")
    assert law.start.shape == (len(law.matrix.frequency), 1)
    ratio = law.start[:, 0] / law.reference.mean(axis=1)
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)


def test_the_window_of_a_sine_s_steady_state_has_a_mean_of_1_and_nothing_at_the_ends() -> None:
    window = settled_window(reference_from("sine:24:1", 44_100.0, 10.0, 0.04, 2, 4), 4_000)
    assert isinstance(window, np.ndarray)
    assert window.mean() == pytest.approx(1.0)
    assert not window[:160].any()
    assert not window[-160:].any()
    assert window.nonzero()[0][[0, -1]].tolist() == [561, 3_439]  # the taper, and 0.1 more
    assert settled_window(reference_from("chirp:40:90:1", 44_100.0, 10.0, 0.04, 2, 4), 4_000) == 1.0

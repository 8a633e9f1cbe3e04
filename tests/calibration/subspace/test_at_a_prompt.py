"""What a person at a prompt does: single channels, lists, samples that are missing, warnings that are read."""

from pathlib import Path

import numpy as np
import pytest

from calibration import subspace
from tests.calibration.resonant_systems import RATE, order_7


def test_a_warning_names_the_line_of_whoever_called() -> None:
    drive, response = order_7().record(600, seed=19)
    response[300] = np.nan
    with pytest.warns(UserWarning, match="1 of 600 samples is missing") as told:
        found = subspace.identify(drive, response, RATE, order=7)
    with pytest.warns(UserWarning, match="1 of 600 samples is missing") as told_again:
        found.compare(drive, response)
    assert {Path(each.filename) for each in (*told, *told_again)} == {Path(__file__)}


@pytest.mark.slow
def test_records_of_a_few_samples_between_gaps_are_told_of_and_held_against() -> None:
    drive, response = order_7().record(4000, seed=5)
    response[::20] = np.nan
    with pytest.warns(UserWarning, match="200 of 4000 samples are missing: 3800 in 200 stretches"):
        found = subspace.identify(drive, response, RATE)
    assert "3800 samples in 200 records" in found.summary()
    assert found.fit.cross_correlation.lag[-1] == 9


def test_single_channels_need_no_second_axis() -> None:
    drive, response = order_7().record(600, seed=19)
    model = subspace.identify(drive, response, RATE, order=7, horizon=20).model
    flat = drive[:, 0], response[:, 0]
    np.testing.assert_array_equal(model.simulate(list(flat[0])), model.simulate(drive))
    np.testing.assert_array_equal(model.predict(*flat), model.predict(drive, response))
    np.testing.assert_array_equal(model.initial_state(*flat), model.initial_state(drive, response))
    with pytest.raises(ValueError, match=r"drive is None, must be \(N, 1\): the model has inputs"):
        model.predict(None, response)


def test_orders_that_were_tried_are_drawn_and_only_where_some_were() -> None:
    drive, response = order_7().record(1500, seed=19)
    found = subspace.identify(drive, response, RATE, order=7)
    axes = found.draw_candidates().axes[0]
    assert [each.get_text() for each in axes.get_legend().get_texts()] == [
        "free run",
        "one step",
        f"order 7, horizon {found.horizon[1]}",
    ]
    with pytest.raises(ValueError, match="there are no candidates to be drawn"):
        subspace.identify(drive, response, RATE, order=7, horizon=20).draw_candidates()


def test_a_response_is_drawn_from_one_period_of_the_record_on_and_no_phase_is_surer_than_unknown() -> None:
    drive, response = order_7().record(600, seed=19)
    idle = np.random.default_rng(2).standard_normal((600, 1))
    found = subspace.identify(np.hstack([drive, idle]), response, RATE, order=7, horizon=20)
    figure = found.bode()
    for axes in figure.axes:
        assert axes.get_lines()[0].get_xdata()[0] == pytest.approx(RATE / 600)
    shaded = [path.vertices[:, 1] for axes in figure.axes[2:] for path in axes.collections[0].get_paths()]
    drawn = [axes.get_lines()[0].get_ydata() for axes in figure.axes[2:]]
    for band, line in zip(shaded, drawn, strict=True):
        assert band.min() >= line.min() - 180.001
        assert band.max() <= line.max() + 180.001

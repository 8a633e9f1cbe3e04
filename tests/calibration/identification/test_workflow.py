"""Identification of a recording: order found, judged on what was held back, labelled with where it comes from."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.identification.report import record_notes
from calibration.identification.workflow import identify_recordings
from ctlblocks.recording import Recording
from tests.calibration.resonant_systems import order_7, order_9
from tests.calibration.subspace.test_feedback import record as closed_loop


def recorded(samples: int = 6000, seed: int = 1) -> Recording:
    """Return a stage's drive and three responses, each about an operating point."""
    drive, response = order_9().record(samples, seed)
    data = np.concatenate([drive + 3.0, 1e-6 * response - 7e-6], axis=1)
    return Recording(("u", "y1", "y2", "y3"), ("V", "m", "m", "m"), 1000.0, data, {"rig": "bench"})


@pytest.mark.parametrize("method", ["n4sid", "moesp", "pem"])
def test_order_and_modes_are_found_and_held_back_data_are_explained(method: str) -> None:
    found = identify_recordings([recorded()], 1, order=None if method == "moesp" else 9, horizon=20, method=method)  # type: ignore[arg-type]
    true = order_9().model.modes
    assert found.model.order == 9
    np.testing.assert_allclose(found.errors.modes.frequency[1:], true.frequency[1:], rtol=0.002)
    np.testing.assert_allclose(found.errors.modes.damping[1:], true.damping[1:], rtol=0.05)
    assert found.fresh.free_run.nrmse.min() > 88
    assert found.fresh.one_step.nrmse.min() > 90
    assert len(found.response) == 1800


def test_the_model_says_where_it_comes_from() -> None:
    model = identify_recordings([recorded(2000)], 1, order=9, horizon=20, hold_back=0.5).model
    assert (model.input_names, model.output_units) == (("u",), ("m", "m", "m"))
    assert model.provenance["rig"] == "bench"
    assert (model.provenance["method"], model.provenance["samples"]) == ("moesp", "1000")


def test_what_is_held_back_plays_no_part() -> None:
    whole = recorded(3000)
    spoiled = np.array(whole.data)
    spoiled[2100:, 1:] = np.random.default_rng(0).standard_normal((900, 3))
    one, other = (identify_recordings([each], 1, order=9, horizon=20) for each in (whole, replace(whole, data=spoiled)))
    np.testing.assert_array_equal(one.model.A, other.model.A)
    assert other.fresh.free_run.nrmse.max() < 10


def test_pem_predicts_no_worse_than_what_it_starts_from() -> None:
    drive, response = order_7().record(4000, seed=4)
    measured = Recording(("u", "y"), ("1", "1"), 1000.0, np.concatenate([drive, response], axis=1))
    fits = [identify_recordings([measured], 1, order=7, horizon=15, method=each).own for each in ("moesp", "pem")]  # type: ignore[arg-type]
    assert fits[1].one_step.nrmse[0] >= fits[0].one_step.nrmse[0]


def test_what_cannot_be_done_is_refused() -> None:
    measured = recorded(500)
    for wrong, complaint in (({"hold_back": 0.95}, "validation share is 0.95"), ({"method": "arx"}, "method is 'arx'")):
        with pytest.raises(ValueError, match=complaint):
            identify_recordings([measured], 1, **wrong)  # type: ignore[arg-type]
    still = np.array(measured.data)
    still[:, 2] = 1.0
    with pytest.raises(ValueError, match="channel 'y2' never changes"):
        identify_recordings([replace(measured, data=still)], 1)


def test_a_delay_is_told_and_does_not_count_as_order() -> None:
    whole = recorded(3000).data
    late = replace(recorded(), data=np.concatenate([whole[20:, :1], whole[:-20, 1:]], axis=1))
    found = identify_recordings([late], 1, order=9, horizon=20)
    assert found.order == 9
    assert found.model.order == 9 + sum(found.started.delays)
    (said,) = record_notes(found)
    assert said.startswith("inputs that come late, which the model has as states more: u by 2")


def test_what_identification_warns_of_is_kept() -> None:
    found = identify_recordings([recorded(200)], 1, horizon=5)
    assert found.notes[0] == "140 samples are few: orders beyond 2 were not tried"
    assert found.notes[0] in record_notes(found)


def test_a_closed_loop_is_identified_as_one_and_told_of() -> None:
    drive, response = closed_loop(6000, 1, 0.5, 1.0)
    measured = Recording(("u", "y"), ("V", "m"), 1.0, np.column_stack([drive, response]))
    found = identify_recordings([measured], 1, order=3, horizon=30)
    assert found.method == "pbsid"
    assert any(note.startswith("u follows from the outputs") for note in found.notes)
    refined = identify_recordings([measured], 1, order=3, horizon=30, method="pem")
    assert refined.method == "pem"
    assert not refined.model.D.any()


def test_samples_far_off_are_replaced_and_judge_no_model() -> None:
    whole = np.array(recorded(3000).data)
    clean = identify_recordings([recorded(3000)], 1, order=9, horizon=20)
    whole[[500, 2800], 1] += 40 * whole[:, 1].std()
    marred = replace(recorded(3000), data=whole)
    found = identify_recordings([marred], 1, order=9, horizon=20)
    assert found.notes[:2] == (
        "1 of 2100 samples of y1 is far off what those around it tell, and replaced",
        "of the validation data, 1 of 900 samples of y1 is far off what those around it tell, and replaced",
    )
    np.testing.assert_allclose(found.fresh.one_step.nrmse, clean.fresh.one_step.nrmse, atol=0.5)
    kept = identify_recordings([marred], 1, order=9, horizon=20, outliers="keep")
    assert not kept.notes
    assert kept.fresh.one_step.nrmse[0] < clean.fresh.one_step.nrmse[0] - 10

from dataclasses import replace

import numpy as np
import pytest

from calibration.comparison_report import comparison_figures, comparison_report
from calibration.model_comparison import (
    APART,
    ComparisonError,
    compare,
    compare_far_fields,
    compared_rows,
    differing_rows,
)
from vibractl.far_field import FarField
from vibractl.transfer_matrix import TransferMatrix

FREQUENCY = np.arange(20.0, 620.0, 0.5)


def model(
    seed: int, noise: float = 0.02, shift: float = 0.0, rig: str = "bench", frequency: np.ndarray = FREQUENCY
) -> TransferMatrix:
    """Return a smooth response with noise of the stated variance, and from 300 to 310 Hz another one by `shift`."""
    rng = np.random.default_rng(seed)
    smooth = np.exp(1j * frequency / 100)[:, None, None] * np.array([[2.0, 0.5], [0.3, 1.5]])
    moved = 1 + shift * ((frequency > 300) & (frequency < 310))
    scatter = rng.standard_normal((*smooth.shape, 2)) @ np.array([1, 1j]) * noise / np.sqrt(2)
    variance = np.full(smooth.shape, noise**2)
    return TransferMatrix(
        frequency, smooth * moved[:, None, None] + scatter, variance, np.ones(smooth.shape), {"rig": rig}
    )


def test_a_model_does_not_differ_from_itself() -> None:
    found = compare(model(1), model(1), "a", "b")
    assert found.normalised.max() == 0
    assert found.relative.max() == 0


def test_two_measurements_of_one_machine_differ_by_their_variances() -> None:
    found = compare(model(1), model(2), "a", "b")
    assert found.normalised.mean() == pytest.approx(1.0, rel=0.05)
    assert np.percentile(found.normalised, 95) == pytest.approx(3.0, rel=0.1)
    assert [row[1] for row in compared_rows(found)] == ["160", "200", "400", "440"]


def test_a_change_is_found_where_it_is() -> None:
    found = compare(model(1), model(2, shift=0.1), "a", "b")
    figures = comparison_figures(found)
    changed = figures["bands"][2]
    assert changed["mean_normalised_difference"] > 1.5
    assert figures["bands"][3]["mean_normalised_difference"] < 1.2
    assert 299 < figures["farthest"][0]["frequency_hz"] < 311
    named = np.array([float(row[0]) for row in differing_rows(found)])
    assert np.diff(np.sort(named)).min() >= APART


def test_models_on_other_grids_are_compared_on_the_coarser_one_where_both_are() -> None:
    other = model(2, frequency=np.arange(50.0, 400.0, 2.0))
    found = compare(model(1), other, "a", "b")
    assert found.frequency.tolist() == other.frequency.tolist()
    assert found.normalised.mean() == pytest.approx(1.0, rel=0.15)


def test_the_report_shows_both_and_says_how_far_apart_they_are() -> None:
    page = comparison_report(compare(model(1), model(2), "tank.h5", "sea.h5")).html()
    assert "tank.h5 and sea.h5" in page
    assert "Normalised" in page or "normalised" in page


def test_models_that_do_not_belong_together_are_refused() -> None:
    with pytest.raises(ComparisonError, match="a was measured on rig 'bench', b on rig 'ship'"):
        compare(model(1), model(1, rig="ship"), "a", "b")
    one = model(1)
    single = TransferMatrix(
        one.frequency, one.response[:, :1], one.variance[:, :1], one.coherence[:, :1], one.provenance
    )
    with pytest.raises(ComparisonError, match="a has 2 accelerometers and 2 coils, b has 1 accelerometers"):
        compare(one, single, "a", "b")
    with pytest.raises(ComparisonError, match="no band in common"):
        compare(one, model(1, frequency=np.arange(1000.0, 1100.0)), "a", "b")


def far_field(seed: int, late: float, lines: np.ndarray = FREQUENCY) -> FarField:
    """Return a far field whose delay is split differently between `delay` and phase."""
    prompt = model(seed, frequency=lines)
    own = np.exp(2j * np.pi * np.outer(lines, [late, 0.0]))[..., None]
    return FarField(replace(prompt, response=prompt.response * own), np.array([0.006 + late, 0.008]))


def test_far_fields_are_compared_whatever_share_of_the_phase_is_called_delay() -> None:
    found = compare_far_fields(far_field(1, 0.0), far_field(2, 0.001), "a", "b")
    assert found.normalised.mean() == pytest.approx(1.0, rel=0.05)
    assert comparison_figures(compare(model(1), model(2), "a", "b"), found)["far_field"]["lines"] == len(FREQUENCY)
    report = comparison_report(compare(model(1), model(2), "a", "b"), found)
    assert [section.title for section in report.sections][2:] == [
        "Both models of the far field",
        "Difference of the far field",
    ]
    assert report.sections[2].plots[0].figure.axes[0].get_ylabel() == "dB re 1 Pa/(m/s²)"


def test_far_fields_of_other_sizes_are_not_compared() -> None:
    first = far_field(1, 0.0)
    prompt = replace(
        first.prompt, **{k: getattr(first.prompt, k)[:, :1] for k in ("response", "variance", "coherence")}
    )
    with pytest.raises(ComparisonError, match="a has 2 hydrophones and 2 accelerometers, b has 1 hydrophones"):
        compare_far_fields(first, FarField(prompt, first.delay[:1]), "a", "b")

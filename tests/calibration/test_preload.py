import numpy as np
import pytest

from calibration.preload import CLEARANCE, clearance, preload_frequencies

PROBES = np.arange(15.0, 650.0, 0.25)


def test_harmonics_and_images_of_the_preload_stay_clear_of_every_probe() -> None:
    preload = preload_frequencies(PROBES, (40.0, 90.0))
    order = np.arange(1, 60)[:, None]
    harmonics = np.abs(order * preload - PROBES).min(axis=0)
    images = np.abs(order * preload - 2 * PROBES).min(axis=0)
    assert harmonics.min() >= CLEARANCE - 1e-9
    assert images.min() >= CLEARANCE / 2 - 1e-9


def test_the_preload_stays_near_the_middle_of_its_band() -> None:
    preload = preload_frequencies(PROBES, (40.0, 90.0))
    assert preload.min() > 48
    assert preload.max() < 75
    assert np.quantile(np.abs(preload - 60), 0.9) < 3


def test_a_band_too_narrow_for_that_clearance_gives_the_clearest_there_is() -> None:
    preload = preload_frequencies(np.array([600.0]), (60.0, 61.0))
    assert 60.0 <= preload[0] <= 61.0
    others = np.linspace(60.0, 61.0, 500)
    assert clearance(np.array([600.0]), preload)[0] == pytest.approx(clearance(np.array(600.0), others).max(), abs=0.05)


@pytest.mark.parametrize(
    ("probe", "preload", "expected"),
    [(120.0, 60.0, 0.0), (90.0, 60.0, 0.0), (101.0, 60.0, 9.0), (80.0, 60.0, 0.0), (82.5, 60.0, 22.5)],
    ids=["a harmonic", "an image", "near a third-order product", "a third-order product", "well between"],
)
def test_clearance_weighs_each_product_by_its_order(probe: float, preload: float, expected: float) -> None:
    assert clearance(np.array([probe]), np.array([preload]))[0] == pytest.approx(expected, abs=1e-9)

"""Blocks of records that are held out: no window reaches into them, and sweeps are told from what repeats."""

import numpy as np
import pytest

from calibration.subspace.estimate import compress
from calibration.subspace.folds import ENOUGH, FOLDS, Folds
from calibration.subspace.signals import Signals, signals
from calibration.subspace.windows import Layout, Windows
from tests.calibration.resonant_systems import order_7, sweep

LONG, SHORT = Layout(12, 12, 1, 1), Layout(5, 5, 1, 1)


def data(*samples: int) -> Signals:
    records = [order_7().record(count, seed) for seed, count in enumerate(samples)]
    return signals([drive for drive, _ in records], [response for _, response in records], True)


@pytest.mark.parametrize("samples", [(400,), (300, 150), (90, 80, 70, 60, 50)])
def test_every_sample_is_held_out_once_and_kept_otherwise(samples: tuple[int, ...]) -> None:
    folds = Folds(data(*samples), LONG, True)
    held = [folds.held_out(fold) for fold in range(FOLDS)]
    assert sum(len(drive) for each in held for drive in each.drives) == sum(samples)
    for fold, each in enumerate(held):
        kept = folds.kept(fold)
        assert sum(map(len, kept.drives)) + sum(map(len, each.drives)) == sum(samples)
        assert np.intersect1d(np.concatenate(kept.responses), np.concatenate(each.responses)).size == 0


@pytest.mark.parametrize("layout", [LONG, SHORT])
def test_what_is_compressed_is_all_windows_outside_of_what_is_held_out(layout: Layout) -> None:
    whole = data(400)
    folds = Folds(whole, LONG, False)
    _, first, last = folds.blocks[1][0]
    sides = [np.concatenate([whole.drives[0], whole.responses[0]], axis=1).T.copy()]
    edge = LONG.past - layout.past  # windows are those about the samples of the longest
    parts = [sides[0][:, edge : first - edge], sides[0][:, last + edge : 400 - edge]]
    parts = [np.ascontiguousarray(part) for part in parts if part.shape[1] >= layout.length]
    wanted = compress(Windows(parts, layout, 1, False), "moesp")
    found = folds.compressed(1, layout, "moesp")
    assert found.windows == wanted.windows
    np.testing.assert_allclose(found.triangle, wanted.triangle, atol=1e-9)


def test_signals_that_depend_on_one_another_are_compressed_by_qr_all_the_same() -> None:
    whole = data(400)
    whole.responses[0][:] = whole.drives[0]
    folds = Folds(whole, LONG, True)
    triangle = folds.compressed(0, SHORT, "moesp").triangle
    assert np.all(np.isfinite(triangle))
    assert np.min(np.abs(np.diag(triangle))) < 1e-9


def test_of_long_records_a_part_is_fitted_and_judged() -> None:
    folds = Folds(data(40_000), LONG, True)
    assert ENOUGH - FOLDS <= sum(map(len, folds.kept(None).drives)) <= ENOUGH


@pytest.mark.parametrize("samples", [300, 3000])
def test_a_sweep_and_a_step_cannot_be_held_out_in_parts(samples: int) -> None:
    step = (np.arange(samples) > samples // 3)[:, None] * 1.0
    for drive, are_alike in ((None, True), (sweep(samples, 5.0, 150.0), False), (step, False)):
        record = order_7().record(samples, seed=5, drive=drive)
        assert Folds(signals(record[:1], record[1:], True), LONG, True).are_alike == are_alike

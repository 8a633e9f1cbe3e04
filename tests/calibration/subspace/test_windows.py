"""Windows compressed into a triangle, by sums of products and by QR, whole and with a segment left out."""

import numpy as np
import pytest

from calibration.subspace import window_kernel
from calibration.subspace.windows import Layout, Windows

LAYOUT = Layout(past=3, future=4, inputs=1, outputs=2)


def records(seed: int = 1) -> list[np.ndarray]:
    """Return two records of coloured noise about a constant, of unlike length."""
    rng = np.random.default_rng(seed)
    whole = rng.standard_normal((3, 500)) + 2.0
    whole[:, 1:] += 0.8 * whole[:, :-1]
    return [np.ascontiguousarray(whole[:, :180]), np.ascontiguousarray(whole[:, 180:])]


def written_out(parts: list[np.ndarray], constant: bool) -> np.ndarray:
    """Return the mean of w w' over all windows, each made by hand."""
    windows = [part[:, start : start + 7].T.ravel() for part in parts for start in range(part.shape[1] - 6)]
    rows = np.array(windows)[:, LAYOUT.order]
    rows = rows - rows.mean(axis=0) if constant else rows
    return rows.T @ rows / len(rows)


def test_rows_are_future_inputs_then_past_then_future_outputs() -> None:
    labels = np.array([[f"{name}{time}" for name in ("u", "y", "z")] for time in range(7)]).ravel()[LAYOUT.order]
    ahead, past, future = LAYOUT.parts
    assert list(labels[ahead]) == ["u3", "u4", "u5", "u6"]
    assert list(labels[past]) == [f"{name}{time}" for time in range(3) for name in ("u", "y", "z")]
    assert list(labels[future]) == [f"{name}{time}" for time in range(3, 7) for name in ("y", "z")]
    assert list(labels[LAYOUT.rows(3, 5, slice(1, None))]) == ["y3", "z3", "y4", "z4"]
    assert list(labels[LAYOUT.rows(1, 2)]) == ["u1", "y1", "z1"]


def test_sums_by_the_hankel_structure_are_those_written_out() -> None:
    signals = records()[1]
    found = np.zeros((21, 21))
    window_kernel.window_products(signals, 20, signals.shape[1] - 6, 7, found)
    rows = np.stack([signals[:, start : start + 7].T.ravel() for start in range(20, signals.shape[1] - 6)])
    np.testing.assert_allclose(np.triu(found), np.triu(rows.T @ rows), rtol=1e-11)


@pytest.mark.parametrize("constant", [True, False])
@pytest.mark.parametrize("segments", [1, 7])
def test_the_triangle_has_the_mean_product_of_the_windows(constant: bool, segments: int) -> None:
    windows = Windows(records(), LAYOUT, segments, constant)
    triangle = windows.triangle()
    assert not np.any(np.triu(triangle, 1))
    np.testing.assert_allclose(triangle @ triangle.T, written_out(records(), constant), rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("constant", [True, False])
def test_where_signals_depend_on_one_another_the_triangle_comes_by_qr(constant: bool) -> None:
    """Its small entries are right to the last digits of the signals, not of their squares."""
    parts = records()
    for part in parts:
        part[2] = part[1] + 1e-6 * part[2]
    triangle = Windows(parts, LAYOUT, 5, constant).triangle()
    rows = np.array([part[:, at : at + 7].T.ravel() for part in parts for at in range(part.shape[1] - 6)])
    rows = rows[:, LAYOUT.order] - constant * rows[:, LAYOUT.order].mean(axis=0)
    expected = np.linalg.qr(rows, mode="r") / np.sqrt(len(rows))
    np.testing.assert_allclose(np.diag(triangle), np.abs(np.diag(expected)), rtol=1e-7)
    assert np.min(np.diag(triangle)) < 1e-5


@pytest.mark.parametrize("spoiled", [False, True])
def test_a_segment_left_out_is_as_if_it_had_not_been(spoiled: bool) -> None:
    """Windows belong to the segment they begin in, so that the whole is a segment and the rest."""
    parts = records()
    if spoiled:
        for part in parts:
            part[2] = part[1] + 1e-7 * part[2]
    windows = Windows(parts, LAYOUT, 5, constant=False)
    whole = windows.count() * windows.triangle() @ windows.triangle().T
    for segment in range(windows.segments):
        rest = windows.triangle(without=[segment])
        left = whole - windows.count(without=[segment]) * rest @ rest.T
        number = windows.count() - windows.count(without=[segment])
        assert np.linalg.matrix_rank(left, tol=1e-6 * np.abs(whole).max(), hermitian=True) <= number
        assert np.min(np.linalg.eigvalsh(left)) > -1e-9 * np.abs(whole).max()


def test_every_record_has_a_segment_of_its_own_at_least() -> None:
    assert Windows(records(), LAYOUT, 1, constant=True).segments == 2
    assert Windows(records(), LAYOUT, 16, constant=True).segments == 16

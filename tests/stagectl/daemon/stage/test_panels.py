"""What is drawn of the errors of a run."""

import numpy as np

from stagectl.daemon.stage.panels import BINS, histogram, spectrum

RATE = 10_000.0


def test_a_histogram_counts_every_sample_and_tells_the_mean_absolute_error() -> None:
    error = np.array([[1e-6, 0.0], [-1e-6, 0.0], [3e-6, 0.0], [1e-6, 0.0]])
    panel = histogram(error, ("x", "y"))
    assert panel.title == "Error, last 1 s, MAE x 1.500, y 0.000 µm"
    one, other = panel.traces
    assert len(one.x) <= BINS + 1
    assert np.allclose([one.y.sum(), other.y.sum()], 1.0)
    assert one.y.max() == 0.5


def test_the_steps_of_a_sensor_make_no_comb() -> None:
    steps = np.random.default_rng(1).normal(0.0, 3.0, (10_000, 1)).round()
    for offset in (0.0, 0.3):
        part = histogram(7.6e-9 * (steps + offset), ("x",)).traces[0].y
        inner = part[part.cumsum().searchsorted(0.1) : part.cumsum().searchsorted(0.9)]
        assert inner.min() > 0.03
        assert np.isclose(part.sum(), 1.0)


def test_errors_of_nothing_have_a_histogram() -> None:
    assert histogram(np.zeros((5, 1)), ("x",)).traces[0].y.sum() == 1.0


def test_a_spectrum_shows_a_line_where_it_is_and_the_power_there_is() -> None:
    time = np.arange(10_000) / RATE
    error = 2e-6 * np.sin(2 * np.pi * 80 * time)[:, np.newaxis]
    trace = spectrum(error, ("x",), RATE).traces[0]
    assert abs(trace.x[trace.y.argmax()] - 80.0) < 2.5
    assert np.isclose((trace.y**2).sum() * (trace.x[1] - trace.x[0]), 2e-12, rtol=0.02)  # half its amplitude squared
    assert trace.x[-1] <= 1_000.0

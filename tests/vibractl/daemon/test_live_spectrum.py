"""The spectrum of what is heard now."""

import numpy as np

from vibractl.config import RigConfig
from vibractl.daemon.live_spectrum import DEEPEST, SECONDS, live_panel, spectrum

RATE = 44100.0


def _tones(*levels: tuple[float, float]) -> np.ndarray:
    """Return a signal of sines, given as (Hz, dB)."""
    time = np.arange(round(SECONDS * RATE)) / RATE
    tones = [10 ** (level / 20) * np.sin(2 * np.pi * frequency * time) for frequency, level in levels]
    return np.sum(tones, axis=0)


def test_lines_are_told_relative_to_the_strongest_of_their_side() -> None:
    signal = np.stack([_tones((60.0, 20.0), (120.0, -25.0)), _tones((80.0, -20.0), (240.0, -50.0))], axis=1)
    frequency, level = spectrum(signal, RATE)
    assert level[frequency == 60.0, 0] == 0.0
    assert np.isclose(level[frequency == 120.0, 0], -45.0, atol=0.01)
    assert np.isclose(level[frequency == 240.0, 1], -30.0, atol=0.01)
    assert level.min() == DEEPEST


def test_the_objective_is_drawn_where_it_holds() -> None:
    config = RigConfig()
    panel = live_panel(np.stack([_tones((60.0, 0.0))] * 2, axis=1), config)
    *sides, limit = panel.traces
    assert [trace.name for trace in sides] == ["response 1", "response 2"]
    assert sides[0].x[-1] <= config.quality.judged_to
    assert (limit.role, *limit.x) == ("limit", config.quality.above, config.quality.judged_to)
    assert set(limit.y) == {config.quality.objective}


def test_before_anything_is_heard_there_are_no_lines() -> None:
    *sides, limit = live_panel(np.zeros((0, 2)), RigConfig()).traces
    assert [len(trace.y) for trace in sides] == [0, 0]
    assert len(limit.y) == 2


def test_silence_is_as_deep_as_can_be() -> None:
    assert (spectrum(np.zeros((100, 1)), RATE)[1] == DEEPEST).all()

"""Multisines within the limit: how loud lines may be, and records shaped by that."""

import numpy as np
import pytest

from calibration.emission_limit import EmissionLimit
from calibration.quiet_multisine import FILLED, doubted, shaped_design
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.judging import Judging
from vibractl.quality import Judge

RIG = rig_file.load(None, RigConfig, ["characterisation.quiet=true", "reference.signal=chirp:40:90:5"])
LIMIT = EmissionLimit.of(RIG)


def test_a_steady_tone_at_the_limit_has_a_line_at_the_limit() -> None:
    judge, rate = Judge(Judging.of(RIG)), RIG.audio.rate / RIG.learning.decimation
    tone = LIMIT.tone * np.sin(2 * np.pi * 300 * np.arange(round(5.4 * rate)) / rate)
    lines = np.abs(judge.lines(np.stack([tone, tone], axis=1)))
    assert lines.max() == pytest.approx(judge.limit.min(), rel=1e-3)


def test_lines_below_100_hz_have_no_limit_but_near_it_and_close_ones_add_up() -> None:
    grid = np.arange(50.0, 200.0)
    allowed = LIMIT.allowed(grid, -30.0)
    assert allowed[grid < 90] == pytest.approx(LIMIT.tone * np.sqrt(10))
    assert allowed[grid >= 90] == pytest.approx(LIMIT.tone)
    assert LIMIT.allowed(np.arange(100.0, 200.0, 0.05), 0.0) == pytest.approx(LIMIT.tone * np.sqrt(5.4 * 0.05))


def test_what_is_heard_is_over_the_limit_by_what_the_ambience_does_not_explain() -> None:
    grid, silence = np.arange(100.0, 200.0), np.zeros((100, 1))
    line = np.zeros((1, 100, 1))
    line[0, 40] = 2 * LIMIT.tone
    assert LIMIT.over(grid, line, silence) == pytest.approx(6.02, abs=0.01)
    silence[41] = 2 * LIMIT.tone
    assert LIMIT.over(grid, line, silence) < -200
    assert LIMIT.over(np.arange(0.0, 100.0), line, silence) < -200


def test_records_take_the_same_part_of_the_limit_on_every_line_but_in_notches() -> None:
    frequency = np.arange(10.0, 660.0, 0.5)
    size = 1 + 20 * np.exp(-((frequency - 300) ** 2) / 5000) - 0.999 * np.exp(-((frequency - 500) ** 2) / 500)
    response = size[:, None, None] * np.array([[3.0, 1j], [1.0, 2.0]])
    design, detection = shaped_design(RIG, frequency, response, LIMIT)
    lines = design.frequency
    gain = np.stack([np.interp(lines, frequency, size * each) for each in (3.0, 2.0)], axis=1)
    emitted = (gain * design.amplitude).sum(axis=1) / LIMIT.tone
    apart = np.abs(lines - 500) > 40
    assert emitted[apart & (lines > 95)].max() <= FILLED * 1.0001
    assert emitted[apart & (lines > 95)].min() > 0.8 * FILLED
    assert emitted[lines < 85] == pytest.approx(FILLED * np.sqrt(10), rel=0.1)
    assert emitted[np.abs(lines - 500) < 2].max() < 0.1 * FILLED
    assert not design.preload.any()
    assert design.records == 5
    assert not np.isin(detection, design.bins).any()


def test_what_so_little_shows_is_doubted_most_where_joints_stick() -> None:
    response = np.full((3, 2, 2), 2.0 + 0j)
    doubt = doubted(np.array([50.0, 150.0, 600.0]), response, np.full(response.shape, 0.01))
    assert np.sqrt(doubt[:, 0, 1] - 0.01) == pytest.approx([1.4, 0.8, 0.2])

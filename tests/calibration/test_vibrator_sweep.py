import numpy as np
import pytest

from calibration.stepped_sine import Tones
from calibration.vibrator_sweep import BATCH, Silence, first_pass, longest_batch, second_pass
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.guard import violation
from vibractl.transfer_matrix import TransferMatrix

CONFIG = RigConfig()


def measured() -> TransferMatrix:
    frequency = np.arange(15.0, 651.0)
    sharp = 1 / (1 - (frequency / 150) ** 2 + 0.01j * frequency / 150)
    response = sharp[:, None, None] * np.array([[1.0, 0.2], [0.3, 1.0]])
    return TransferMatrix(frequency, response, np.ones(response.shape), np.ones(response.shape))


def tones(plan_batches: object) -> list[Tones]:
    return [batch for batch in plan_batches if isinstance(batch, Tones)]  # type: ignore[attr-defined]


def test_the_first_pass_is_silence_and_then_every_hertz_of_the_band() -> None:
    plan = first_pass(CONFIG)
    assert isinstance(plan.batches[0], Silence)
    played = np.concatenate([batch.frequency for batch in tones(plan.batches)])
    assert played.tolist() == np.arange(15.0, 651.0).tolist()


def test_no_batch_takes_longer_than_the_line_is_opened_for() -> None:
    slow = rig_file.load(None, RigConfig, ["characterisation.tone=10", "characterisation.settle=10"])
    for config in (CONFIG, slow):
        longest = max(batch.samples for batch in first_pass(config).batches) / config.audio.rate
        assert longest < longest_batch(config)
    assert max(batch.samples for batch in first_pass(CONFIG).batches) / CONFIG.audio.rate < BATCH + 3


def test_the_second_pass_has_more_lines_and_more_patience_at_a_sharp_mode() -> None:
    batches = tones(second_pass(CONFIG, measured()).batches)
    frequency, settle = (np.concatenate([getattr(batch, key) for batch in batches]) for key in ("frequency", "settle"))
    near = np.abs(frequency - 150) < 2
    assert np.diff(frequency)[near[:-1]].max() <= 0.5
    assert settle[near].min() > 0.5
    assert settle[np.abs(frequency - 600) < 20].max() == pytest.approx(CONFIG.characterisation.settle)


def test_the_guard_lets_every_batch_pass() -> None:
    batch = tones(first_pass(CONFIG).batches)[3]
    assert violation(batch.drive(), CONFIG.limits, CONFIG.audio.rate) is None


def test_the_number_of_passes_is_no_setting_of_the_first() -> None:
    one = rig_file.load(None, RigConfig, ["characterisation.passes=1", "learning.decimation=1"])
    assert first_pass(one).fingerprint == first_pass(CONFIG).fingerprint


@pytest.mark.parametrize("changed", ["characterisation.probe=0.2", "simulator.options.seed=3", "rig.name=other"])
def test_what_the_recording_depends_on_is_a_setting(changed: str) -> None:
    other = rig_file.load(None, RigConfig, [changed])
    assert first_pass(other).fingerprint != first_pass(CONFIG).fingerprint


def test_another_first_pass_gives_another_plan_for_the_second() -> None:
    first = measured()
    other = TransferMatrix(first.frequency, np.roll(first.response, 50, axis=0), first.variance, first.coherence)
    assert second_pass(CONFIG, first).fingerprint != second_pass(CONFIG, other).fingerprint

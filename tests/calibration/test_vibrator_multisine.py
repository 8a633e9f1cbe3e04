import numpy as np
import pytest

from calibration.multisine import Record
from calibration.vibrator import refuse_unfit
from calibration.vibrator_multisine import emitted_seconds, flat_design, multisine_plan
from rigkit import config as rig_file
from vibractl.config import RigConfig

METHOD = "characterisation.method=multisine"


def config(*settings: str) -> RigConfig:
    return rig_file.load(None, RigConfig, [METHOD, *(f"characterisation.{text}" for text in settings)])


def test_eight_records_are_45_seconds_and_silence_is_not_counted() -> None:
    rig = config()
    design, _ = flat_design(rig)
    plan = multisine_plan(rig, "multisine", design)
    assert emitted_seconds(plan) == pytest.approx(44.8)
    assert plan.seconds == pytest.approx(44.8 + 7.0)


def test_power_and_level_are_what_the_settings_say() -> None:
    design, _ = flat_design(config("level=-20", "operating=0.5"))
    assert np.sqrt(np.mean(design.preload**2)) == pytest.approx(0.5)
    per_hz = np.sum(design.amplitude[:, 0] ** 2) / 2 / (np.ptp(design.bins) * 0.2)
    assert 10 * np.log10(per_hz / (0.5**2 / 50)) == pytest.approx(-20, abs=0.1)


def test_lines_reach_beyond_the_band_so_that_its_ends_are_inside_a_window() -> None:
    design, detection = flat_design(config())
    assert design.bins[0] * 0.2 < 15 - 2
    assert design.bins[-1] * 0.2 > 650 + 2
    assert np.all(design.bins % 2 == 1)
    assert len(detection) == pytest.approx(len(design.bins) / 4, rel=0.02)


def test_another_level_is_another_plan() -> None:
    plans = [multisine_plan(rig, "multisine", flat_design(rig)[0]) for rig in (config(), config("level=-29"))]
    assert plans[0].fingerprint != plans[1].fingerprint
    assert plans[0].fingerprint == multisine_plan(config(), "multisine", flat_design(config())[0]).fingerprint


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (("operating=8",), "must be <= limits.peak, 9 V"),
        (("records=2",), "characterisation.records is 2, must be > 2"),
        (("records=5", "quiet=true"), "must be > 5 for 2 coils and quiet records"),
        (("around=reference", "quiet=true"), "around is reference, must be band: characterisation.quiet is true"),
        (
            ("around=reference", "method=both"),
            "around is reference, must be band: characterisation.method is both, must",
        ),
        (("method=both", "quiet=true"), "quiet is true, but method is both, must be multisine: tones are not quiet"),
        (("band=[60, 66]", "period=1"), "must be >= 10.5 Hz for a polynomial over 17 bins"),
        (("band=[0.1, 66]",), "begins at 0.1 Hz, must be >= 0.2 Hz"),
    ],
)
def test_what_could_not_end_in_a_model_is_refused(settings: tuple[str, ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        refuse_unfit(config(*settings))


def test_an_rms_above_the_guards_limit_is_refused() -> None:
    rig = rig_file.load(None, RigConfig, [METHOD, "limits.rms=0.3"])
    with pytest.raises(ValueError, match=r"with rms 0.3\d+ V, must be <= limits.rms, 0.3 V"):
        refuse_unfit(rig)


def test_the_limits_hold_for_every_record_that_is_played() -> None:
    rig = config("operating=2.5")
    refuse_unfit(rig)
    design, _ = flat_design(rig)
    assert max(np.abs(Record(design, number).drive()).max() for number in range(8)) <= rig.limits.peak

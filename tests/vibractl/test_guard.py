"""The guard lets nothing out that breaks a limit, and changes nothing that does not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from vibractl.config import Limits
from vibractl.guard import Guard, Violation, as_violation, violation

RATE = 44_100.0
LIMITS = Limits(peak=9.0, slew=20_000.0, rms=5.0, rms_seconds=0.1, ramp=0.01)
RAMP = 441


def run(guard: Guard, request: np.ndarray, frames: int = 64) -> np.ndarray:
    """Return what the guard lets out, in frames."""
    output = np.full_like(request, np.nan)
    for start in range(0, len(request), frames):
        guard.process(request[start : start + frames], output[start : start + frames])
    return output


def opened(limits: Limits = LIMITS, width: int = 2) -> Guard:
    """Return a guard that is fully open."""
    guard = Guard(limits, width)
    guard.prepare(RATE, 64)
    guard.open()
    run(guard, np.zeros((RAMP + 1, width)))
    return guard


def tones(samples: int, amplitude: float = 3.0) -> np.ndarray:
    time = np.arange(samples) / RATE
    return amplitude * np.sin(2 * np.pi * np.array([40.0, 90.0]) * time[:, None])


def test_a_new_guard_is_closed_and_lets_out_zeros_even_for_nan() -> None:
    guard = Guard(LIMITS, 2)
    guard.prepare(RATE, 64)
    assert not run(guard, np.full((100, 2), np.nan)).any()
    assert guard.is_closed
    assert not guard.latched


def test_fully_open_the_output_is_the_request_bit_for_bit() -> None:
    request = tones(5000) * np.random.default_rng(1).uniform(0.9999, 1.0, (5000, 1))
    guard = opened()
    assert guard.is_open
    assert run(guard, request).tobytes() == request.tobytes()


def test_opening_follows_a_raised_cosine_that_takes_the_ramp_time() -> None:
    guard = Guard(LIMITS, 1)
    guard.prepare(RATE, 64)
    guard.open()
    output = run(guard, np.ones((2 * RAMP, 1)))[:, 0]
    expected = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, RAMP + 1) / RAMP)
    np.testing.assert_allclose(output[:RAMP], expected, atol=1e-15)
    assert (output[RAMP:] == 1.0).all()


def test_closing_ramps_down_to_exactly_zero_and_opening_half_way_goes_up_again() -> None:
    guard = opened(width=1)
    guard.close()
    half = run(guard, np.full((RAMP // 2, 1), 0.2))[:, 0]
    assert (np.diff(half) < 0).all()
    assert not guard.is_closed
    guard.open()
    up = run(guard, np.full((RAMP, 1), 0.2))[:, 0]
    assert up[0] > half[-1]
    assert up[-1] == 0.2
    guard.close()
    assert not run(guard, np.full((RAMP + 1, 1), 0.2))[RAMP - 1 :].any()
    assert guard.is_closed
    assert not guard.latched


@pytest.mark.parametrize("frames", [1, 7, 64, 4000])
def test_the_output_does_not_depend_on_the_frames(frames: int) -> None:
    request = tones(4000)
    request[2000, 1] = 9.5
    whole = run(opened(), request, 4000)
    assert run(opened(), request, frames).tobytes() == whole.tobytes()


@pytest.mark.parametrize(
    ("limit", "sample", "value", "allowed"),
    [
        ("finite", 300, math.nan, math.inf),
        ("finite", 300, math.inf, math.inf),
        ("finite", 300, -math.inf, math.inf),
        ("peak", 300, -9.01, 9.0),
    ],
)
def test_a_bad_sample_never_leaves_and_is_named(limit: str, sample: int, value: float, allowed: float) -> None:
    request = np.zeros((2000, 2))
    request[:, 0] = 1.0 * np.minimum(1, np.arange(2000) / 100)
    request[sample, 1] = value
    guard = opened()
    output = run(guard, request)
    found = guard.violation
    assert found is not None
    assert (found.limit, found.channel, found.allowed) == (limit, 1, allowed)
    assert found.sample == RAMP + 1 + sample
    np.testing.assert_equal(found.value, value)
    assert np.isfinite(output).all()
    assert np.abs(output).max() <= 1.0


def test_a_peak_of_exactly_the_limit_passes_and_the_next_float_does_not() -> None:
    slow = Limits(peak=1.0, slew=1e8, rms=5.0, rms_seconds=0.1, ramp=0.01)
    assert violation(np.full((3, 1), 1.0), slow, RATE) is None
    assert violation(np.full((3, 1), np.nextafter(1.0, 2)), slow, RATE) is not None


def test_a_step_is_a_slew_violation_with_its_rate_of_change() -> None:
    request = np.zeros((1000, 2))
    request[500:, 0] = -0.5
    guard = opened()
    output = run(guard, request)
    assert guard.violation == Violation("slew", 0, RAMP + 501, -0.5 * RATE, 20_000.0)
    assert not output.any()


def test_a_slew_violation_tells_the_change_from_the_sample_before_and_counts_drives_from_1() -> None:
    request = np.zeros((1000, 2))
    request[500:, 1] = 0.3 * np.minimum(np.arange(500), 1)
    request[700:, 1] = 1.3
    guard = opened()
    run(guard, request)
    broken = guard.violation
    assert broken is not None
    assert str(broken) == f"drive 2 asks for {1.0 * RATE:g} V/s at sample {RAMP + 701}, limits.slew is 20000 V/s"
    assert str(replace(broken, channel=2)).startswith("drive 3 ")
    assert str(replace(broken, channel=0)).startswith("drive 1 ")


def test_a_lasting_drive_breaks_the_rms_limit_when_its_exponential_mean_does() -> None:
    ramp = np.minimum(1, np.arange(20_000) / 500)[:, None]
    guard = opened(width=1)
    output = run(guard, 6.0 * ramp)
    found = guard.violation
    assert found is not None
    assert found.limit == "rms"
    assert found.allowed == 5.0
    forget, mean, expected = 1 - math.exp(-1 / (0.1 * RATE)), 0.0, -1
    while mean <= 25:
        expected += 1
        mean += forget * ((6.0 * ramp[expected, 0]) ** 2 - mean)
    assert found.sample == RAMP + 1 + expected
    assert found.value == pytest.approx(5.0, abs=1e-3)
    assert np.abs(output[:, 0]).max() == 6.0
    assert not output[-1].any()


def test_the_rms_mean_is_that_of_the_output_so_that_a_pause_counts() -> None:
    burst = 8.9 * np.sin(np.pi * np.arange(3000) / 3000)[:, None] ** 2
    pause = np.zeros((20_000, 1))
    assert violation(np.concatenate((burst, pause, burst)), LIMITS, RATE) is None
    assert violation(np.concatenate((burst, burst, burst, burst)), LIMITS, RATE) is not None


def test_the_fade_is_a_raised_cosine_from_the_last_good_value_and_obeys_slew() -> None:
    tight = Limits(peak=9.0, slew=1500.0, rms=9.0, rms_seconds=0.1, ramp=0.01)
    request = 8.9 * np.minimum(1, np.arange(3000) / 600)[:, None]
    request[2000] = 100.0
    guard = opened(tight, 1)
    output = run(guard, request)[:, 0]
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, RAMP + 1) / RAMP)
    np.testing.assert_allclose(output[2000 : 2000 + RAMP], 8.9 * fade, atol=1e-14)
    assert not output[2000 + RAMP - 1 :].any()
    assert np.abs(np.diff(output[1999:])).max() * RATE <= 1500.0


def test_all_drives_fade_when_one_breaks_a_limit() -> None:
    request = tones(3000)
    request[1500, 0] = math.nan
    output = run(opened(), request)
    assert output[1500 : 1500 + RAMP - 1, 1].any()
    assert not output[1500 + RAMP :].any()


def test_a_latched_guard_ignores_open_until_a_person_clears_it() -> None:
    guard = opened(width=1)
    run(guard, np.full((2 * RAMP, 1), math.nan))
    guard.open()
    assert not run(guard, np.ones((2 * RAMP, 1))).any()
    assert guard.latched
    found = guard.clear("Ada")
    assert found.limit == "finite"
    assert not guard.latched
    assert guard.violation is None
    assert guard.is_closed
    assert not run(guard, np.ones((2 * RAMP, 1))).any()
    guard.open()
    assert run(guard, np.ones((2 * RAMP, 1)))[-1] == 1.0


def test_clearing_needs_a_name_a_violation_and_the_end_of_the_fade() -> None:
    guard = opened(width=1)
    with pytest.raises(ValueError, match="not latched, Ada has nothing"):
        guard.clear("Ada")
    run(guard, np.full((1, 1), math.nan))
    with pytest.raises(ValueError, match="still fades to zero"):
        guard.clear("Ada")
    run(guard, np.zeros((RAMP, 1)))
    with pytest.raises(ValueError, match="must be a person's name"):
        guard.clear(" ")


def test_a_latch_survives_prepare_but_everything_else_starts_anew() -> None:
    guard = opened(width=1)
    guard.prepare(RATE, 64)
    assert guard.is_closed
    assert not guard.latched
    guard.open()
    run(guard, np.zeros((RAMP, 1)))
    run(guard, np.full((9, 1), math.nan))
    guard.prepare(RATE, 64)
    guard.open()
    assert guard.latched
    assert guard.is_closed
    assert not run(guard, np.ones((2 * RAMP, 1))).any()


def test_two_runs_after_prepare_are_the_same_bit_for_bit() -> None:
    request = tones(4000, 6.9)
    guard = Guard(Limits(rms=4.0, rms_seconds=0.02), 2)
    runs = []
    for _ in range(2):
        guard.prepare(RATE, 64)
        guard.open()
        runs.append(run(guard, request))
        assert guard.latched
        guard.clear("the test")
    assert runs[0].tobytes() == runs[1].tobytes()


def test_a_whole_drive_is_checked_from_rest_to_rest() -> None:
    drive = tones(4410)
    assert violation(drive, LIMITS, RATE) is None
    cut = drive[: int(RATE / 90 / 4)]
    found = violation(cut, LIMITS, RATE)
    assert found is not None
    assert found.limit == "slew"
    assert found.sample == len(cut)
    drive[4000, 0] = math.nan
    found = violation(drive, LIMITS, RATE)
    assert found is not None
    assert (found.limit, found.sample, found.channel) == ("finite", 4000, 0)


def test_a_ramp_too_short_for_the_slew_limit_is_refused_with_the_shortest() -> None:
    with pytest.raises(ValueError, match=r"limits.ramp is 0.0005 s, must be >= 0.000707 s"):
        Guard(Limits(ramp=0.0005), 2)


def test_the_latch_as_numbers_reads_as_the_violation() -> None:
    guard = opened(width=1)
    run(guard, np.full((5, 1), 9.5))
    assert as_violation(guard.latch) == guard.violation
    assert str(guard.violation) == "drive 1 asks for 9.5 V at sample 442, limits.peak is 9 V"


def test_a_long_silence_leaves_no_mean_that_is_subnormal() -> None:
    """The callback goes on for days; a number that dies away slows some processors down."""
    guard = opened(Limits(peak=9.0, slew=1e6, rms=5.0, rms_seconds=1e-3, ramp=0.01))
    run(guard, tones(2_000))
    run(guard, np.zeros((40_000, 2)))
    assert guard._channels.view(float).any() == 0.0  # noqa: SLF001

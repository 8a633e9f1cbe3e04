import numpy as np
import pytest

from calibration.multisine import Design, Record, codes, low_crest, odd_lines

PERIOD, RATE, RECORDS = 4_000, 1_000.0, 8


def design(inputs: int = 2, records: int = RECORDS) -> Design:
    rng = np.random.default_rng(1)
    bins, _ = odd_lines(20, 800, 5, rng)
    shape = (len(bins), inputs)
    preload = low_crest(np.arange(161, 321, 8), PERIOD, 0.3, rng)
    phase, code = 2 * np.pi * rng.random(shape), codes(len(bins), inputs, records)
    return Design(PERIOD, RATE, records, bins, np.full(shape, 0.01), phase, code, preload[:, None], (161, 320), 500)


def test_the_multisine_cancels_over_all_records_and_leaves_the_preload() -> None:
    made = design()
    mean = np.mean([made.one_period(number) for number in range(RECORDS)], axis=0)
    assert np.allclose(mean, made.preload, atol=1e-12)


@pytest.mark.parametrize(("inputs", "records"), [(1, 2), (2, 8), (3, 4), (4, 9)])
def test_each_line_can_be_read_for_one_input_without_the_others(inputs: int, records: int) -> None:
    made = design(inputs, records)
    spectra = np.array([np.fft.rfft(made.one_period(n), axis=0)[made.bins] * 2 / PERIOD for n in range(records)])
    turn = np.exp(-2j * np.pi / records * np.arange(records)[:, None, None] * made.code)
    read = np.einsum("rli,rlc->lic", spectra, turn) / records
    wanted = (made.amplitude * np.exp(1j * made.phase))[:, :, None] * np.eye(inputs)
    assert np.allclose(read, wanted, atol=1e-12)


def test_neighbouring_lines_carry_different_codes() -> None:
    code = codes(20, 2, 8)
    for step in (1, 2):
        assert np.all(code[step:] != code[:-step])
    assert code.min() == 1
    assert code.max() == 6


def test_too_few_records_are_refused() -> None:
    with pytest.raises(ValueError, match="3 records, must be more than 3 for 3 inputs"):
        codes(5, 3, 3)


def test_lines_are_odd_and_one_in_a_group_is_left_out_at_random() -> None:
    excited, detection = odd_lines(10, 209, 5, np.random.default_rng(2))
    assert np.all(excited % 2 == 1)
    assert len(detection) == 20
    assert sorted([*excited, *detection]) == list(range(11, 210, 2))
    assert len(set(np.diff(detection))) > 3


def test_a_record_goes_from_rest_to_rest_and_holds_one_whole_period() -> None:
    record = Record(design(), 3)
    drive = record.drive()
    assert len(drive) == record.samples == 500 + PERIOD + 100
    assert np.allclose(drive[record.window], design().one_period(3))
    assert np.abs(drive[[0, -1]]).max() < 1e-3
    assert np.allclose(drive[200:500], drive[200 + PERIOD : 500 + PERIOD])


def test_the_preload_has_its_rms_and_less_of_a_crest_than_chance_gives() -> None:
    bins = np.arange(161, 321, 8)
    made = low_crest(bins, PERIOD, 0.36, np.random.default_rng(3))
    assert np.sqrt(np.mean(made**2)) == pytest.approx(0.36)
    spectrum = np.abs(np.fft.rfft(made))
    assert spectrum[np.setdiff1d(np.arange(len(spectrum)), bins)].max() < 1e-9 * spectrum.max()
    phases = 2j * np.pi * np.random.default_rng(3).random(len(bins))
    spread = np.zeros(PERIOD // 2 + 1, complex)
    spread[bins] = np.exp(phases)
    by_chance = np.fft.irfft(spread, PERIOD)
    assert np.abs(made).max() / 0.36 < 0.8 * np.abs(by_chance).max() / by_chance.std()

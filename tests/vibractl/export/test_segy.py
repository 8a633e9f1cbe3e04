"""A run as SEG-Y, read back by segyio and byte by byte, and beside files that recorders wrote."""

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import segyio

from tests.vibractl.export.exported_run import REAL, recorded_run, with_pressure
from vibractl.export.content import Content, read_content
from vibractl.export.segy import interval_us, resampled, write_segy

CHANNELS = ("reference_1", "reference_2", "drive_1", "drive_2", "response_1", "response_2")


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return read_content(recorded_run(tmp_path_factory.mktemp("run")), "all")


@pytest.fixture(scope="module")
def file(content: Content, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("segy") / "run.sgy"
    write_segy(path, content)
    return path


def test_there_is_a_trace_for_each_channel_and_shot(content: Content, file: Path) -> None:
    field = segyio.TraceField
    with segyio.open(file, ignore_geometry=True) as read:
        assert read.tracecount == 3 * len(CHANNELS)
        assert segyio.tools.dt(read) == 500.0
        assert read.attributes(field.FieldRecord)[:].tolist() == [1] * 6 + [2] * 6 + [3] * 6
        assert read.attributes(field.TraceNumber)[:6].tolist() == [1, 2, 3, 4, 5, 6]
        assert read.attributes(field.TraceIdentificationCode)[:6].tolist() == [21, 21, 6, 6, 1, 1]
        assert read.attributes(field.TraceValueMeasurementUnit)[:6].tolist() == [7, 7, 2, 2, 7, 7]
        for number in content.files:
            record = content.shot(number)
            whole = np.hstack([content.reference, record.data])
            wanted = resampled(whole, 44_100, 500).astype(np.float32)
            for channel in range(len(CHANNELS)):
                np.testing.assert_array_equal(read.trace[6 * number + channel], wanted[:, channel])


def test_the_headers_stand_at_the_bytes_of_the_standard(file: Path) -> None:
    """SEG-Y rev 1 (2002), bytes counted from 1."""
    raw = file.read_bytes()

    def word(byte: int, start: int = 0) -> int:
        return int(struct.unpack_from(">h", raw, start + byte - 1)[0])

    text = raw[:3200].decode("cp037")
    assert text.startswith("C 1 RIG simulated-vibrator, RUN run")
    assert text[38 * 80 :].split() == ["C39", "SEG", "Y", "REV1", "C40", "END", "TEXTUAL", "HEADER"]
    assert [word(byte) for byte in (3213, 3215, 3217, 3219, 3221, 3225)] == [2, 4, 500, 23, 2800 + 400, 5]
    assert [word(byte) for byte in (3233, 3235, 3237, 3239, 3255)] == [40, 90, 1000, 1, 1]
    assert [word(byte) for byte in (3501, 3503, 3505)] == [0x0100, 1, 0]
    assert len(raw) == 3600 + 18 * (240 + 4 * word(3221))
    assert [word(byte, 3600) for byte in (29, 109, 115, 117, 125, 127, 129, 131, 133, 139)] == [
        21, -200, 3200, 500, 1, 40, 90, 1000, 1, 2
    ]  # fmt: skip
    first = np.frombuffer(raw, ">f4", word(3221), 3600 + 240)
    with segyio.open(file, ignore_geometry=True) as read:
        np.testing.assert_array_equal(first, read.trace[0])


def test_the_text_says_what_was_done_to_the_rate_and_what_each_trace_is(file: Path) -> None:
    text = file.read_bytes()[:3200].decode("cp037")
    assert "RECORDED AT 44100 SAMPLES/S, WHICH IS NO WHOLE NUMBER OF MICROSECONDS" in text
    assert "RESAMPLED TO EXACTLY 500 US" in text
    assert all(name in text for name in CHANNELS)
    assert "BEGINS 200.0000 MS AFTER THE FIRST SAMPLE" in text


def test_resampling_keeps_a_tone_of_the_band_and_its_time() -> None:
    rate, interval = 44_100, 500
    time = np.arange(44_100 * 2) / rate
    new = np.arange(4_000) * interval * 1e-6
    for tone in (40.0, 650.0, 799.0):
        heard = resampled(np.cos(2 * np.pi * tone * time)[:, None], rate, interval)[:, 0]
        middle = slice(200, 3_800)
        np.testing.assert_allclose(heard[middle], np.cos(2 * np.pi * tone * new)[middle], atol=3e-5)


def test_what_lies_above_half_the_new_rate_is_gone() -> None:
    time = np.arange(44_100) / 44_100
    for tone in (1_001.0, 1_960.0, 15_000.0):
        heard = resampled(np.cos(2 * np.pi * tone * time)[:, None], 44_100, 500)
        assert np.abs(heard[200:-200]).max() < 3e-5


@pytest.mark.parametrize(("highest", "interval"), [(200.0, 2_000), (390.0, 1_000), (650.0, 500), (8_000.0, 50)])
def test_the_interval_is_the_longest_that_holds_the_band(highest: float, interval: int) -> None:
    assert interval_us(highest) == interval


def test_a_band_that_no_interval_holds_is_refused() -> None:
    with pytest.raises(ValueError, match="learning.band goes to 9000 Hz, must be <= 8000 Hz for SEG-Y"):
        interval_us(9_000.0)


def test_a_shot_of_more_samples_than_two_bytes_count_is_refused(content: Content, tmp_path: Path) -> None:
    long = replace(content, reference=np.zeros((44_100 * 17, 2)))
    with pytest.raises(ValueError, match="a shot has 34000 samples at 500 us, must be <= 32767 for SEG-Y"):
        write_segy(tmp_path / "long.sgy", long)


def test_a_far_field_sensor_goes_along_as_a_pressure(content: Content, tmp_path: Path) -> None:
    write_segy(tmp_path / "run.sgy", replace(content, files=with_pressure(content, tmp_path)))
    field = segyio.TraceField
    with segyio.open(tmp_path / "run.sgy", ignore_geometry=True) as read:
        assert read.attributes(field.TraceIdentificationCode)[:].tolist() == [21, 21, 6, 6, 1, 1, 11]
        assert read.attributes(field.TraceValueMeasurementUnit)[:].tolist() == [7, 7, 2, 2, 7, 7, 1]


@pytest.mark.skipif(not (REAL / "segy").is_dir(), reason="no files of recorders here")
def test_the_headers_are_where_recorders_put_them(file: Path) -> None:
    """Interval, samples and format of a rev 0 survey and a field recorder, by the bytes that ours are tested by."""
    for name, interval, samples, code in (
        ("ld0042_file_00018.sgy_first_trace", 2_000, 2_050, 1),
        ("1.sgy_first_trace", 250, 8_000, 2),
    ):
        raw = (REAL / "segy" / name).read_bytes()
        assert struct.unpack_from(">3h", raw, 3216)[0] == interval
        assert struct.unpack_from(">h", raw, 3220)[0] == samples
        assert struct.unpack_from(">h", raw, 3224)[0] == code
        assert struct.unpack_from(">2h", raw, 3600 + 114) == (samples, interval)
    lithoprobe = (REAL / "segy" / "ld0042_file_00018.sgy_first_trace").read_bytes()
    assert lithoprobe[:80].decode("cp037").startswith("C01CLIENT: LITHOPROBE")
    assert file.read_bytes()[0] == lithoprobe[0] == 0xC3  # an EBCDIC C

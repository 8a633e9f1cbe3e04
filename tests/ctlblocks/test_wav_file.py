"""WAV files of this project and of others, whole and damaged."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks import wav_file
from ctlblocks.recording import Recording, RecordingError, read, write

DATA = np.random.default_rng(4).uniform(-1, 1, (20, 2))


def recording(**changed: object) -> Recording:
    fields: dict[str, object] = {"names": ("a", "b"), "units": ("V", "V"), "rate": 44_100.0, "data": DATA}
    return Recording(**(fields | changed))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("subtype", "dtype", "step"),
    [("PCM_16", "float32", 2.0**-15), ("PCM_24", "float32", 2.0**-23), ("PCM_32", "float64", 2.0**-31)],
)
def test_a_foreign_wav_gets_channel_numbers_and_no_unit(tmp_path: Path, subtype: str, dtype: str, step: float) -> None:
    path = tmp_path / "other.wav"
    soundfile.write(path, DATA, 48_000, subtype)
    found = read(path)
    assert (found.names, found.units, found.rate) == (("channel_1", "channel_2"), ("1", "1"), 48_000.0)
    assert found.provenance == {}
    assert found.data.dtype == dtype
    assert np.abs(found.data - DATA).max() <= step


def test_a_foreign_comment_and_foreign_chunks_do_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "other.wav"
    with soundfile.SoundFile(path, "w", 8_000, 1, "PCM_16") as file:
        file.comment = '{"rate": 3}'
        file.write(np.zeros(7))
    whole = path.read_bytes()
    odd, again = b"LIST" + struct.pack("<I", 5) + b"adtl1\0", b"LIST" + struct.pack("<I", 4) + b"adtl"
    whole = whole[12:36] + odd + whole[36:] + again + odd
    path.write_bytes(b"RIFF" + struct.pack("<I", len(whole) + 4) + b"WAVE" + whole)
    assert read(path).names == ("channel_1",)
    assert len(read(path).data) == 7


def test_a_compressed_wav_is_refused_by_its_coding(tmp_path: Path) -> None:
    path = tmp_path / "other.wav"
    soundfile.write(path, DATA, 8_000, "ULAW")
    with pytest.raises(RecordingError, match=r"other.wav: samples are ULAW, must be one of FLOAT, PCM_16"):
        read(path)


def test_a_flac_in_the_name_of_a_wav_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.wav"
    soundfile.write(path, DATA, 8_000, format="FLAC")
    with pytest.raises(RecordingError, match=r"other.wav: not a WAV file, or its header is cut off \(\d+ bytes\)"):
        read(path)


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (4, 7, r"the header says 15 bytes, the file has \d+"),
        (22, 3, "the header does not add up: 3 channels of 64 bits in 16 bytes"),
        (24, 96_000, "the header does not add up: .* 96000 samples/s in 705600 bytes/s"),
        (32, 0, "the header does not add up: 2 channels of 64 bits in 0 bytes"),
        (40, 2**31, "the chunk b'fact' of 2147483648 bytes ends behind the file"),
        (36, int.from_bytes(b"data", "little"), "the chunk b'data' of 4 bytes ends behind the file, or comes twice"),
        (8, int.from_bytes(b"AVI ", "little"), "not a WAV file"),
        (12, 0, "no samples, or no header"),
    ],
)
def test_a_header_that_does_not_fit_is_refused_with_what_it_says(
    tmp_path: Path, place: int, value: int, message: str
) -> None:
    path = tmp_path / "x.wav"
    write(path, recording())
    changed = bytearray(path.read_bytes())
    size = 2 if place in (22, 32) else 4
    changed[place : place + size] = value.to_bytes(size, "little")
    path.write_bytes(changed)
    with pytest.raises(RecordingError, match=rf"x.wav: .*{message}"):
        read(path)


def test_a_header_of_no_channels_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    write(path, recording())
    changed = bytearray(path.read_bytes())
    changed[22:24] = changed[32:34] = bytes(2)
    changed[28:32] = bytes(4)
    path.write_bytes(changed)
    with pytest.raises(RecordingError, match="the header does not add up: 0 channels of 64 bits in 0 bytes"):
        read(path)


def test_samples_that_cannot_all_be_read_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "x.wav", recording())
    monkeypatch.setattr(soundfile.SoundFile, "read", lambda *_, **__: DATA[:19])  # as on a bad disk
    with pytest.raises(RecordingError, match=r"are \(19, 2, 44100\), the header says \(20, 2, 44100\)"):
        read(tmp_path / "x.wav")


def test_a_length_of_samples_that_is_no_multiple_of_a_frame_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    write(path, recording())
    whole = bytearray(path.read_bytes())
    place = whole.index(b"data")
    whole[place + 4 : place + 8] = struct.pack("<I", 312)
    whole[4:8] = struct.pack("<I", len(whole) - 16)
    path.write_bytes(whole[:-8])
    with pytest.raises(RecordingError, match="does not add up: .* 312 bytes of samples"):
        read(path)


def test_a_wav_without_a_sample_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    soundfile.write(path, np.zeros((0, 2)), 44_100, "FLOAT")
    with pytest.raises(RecordingError, match=r"x.wav: the WAV has no samples"):
        read(path)


@pytest.mark.parametrize(
    ("about", "message"),
    [
        ('{"ctlblocks": 1, "names": ["a", "b"]', "Expecting"),
        ('{"ctlblocks": 1, "names": ["a"], "units": ["V", "V"]}', r"names are \['a'\], must be 2 printable"),
        ('{"ctlblocks": 1, "names": 3}', "int"),
        ('{"ctlblocks": 1, "rate": 3}', "rate"),
        ('{"ctlblocks": 1, "gain": 3}', "gain"),
        ('{"ctlblocks": 1, "provenance": ["a"]}', ""),
        ('{"ctlblocks": 1, "names": ' + "[" * 20_000, ""),
    ],
)
def test_names_and_units_that_cannot_be_trusted_are_refused(tmp_path: Path, about: str, message: str) -> None:
    path = tmp_path / "x.wav"
    with soundfile.SoundFile(path, "w", 8_000, 2, "FLOAT") as file:
        file.comment = about
        file.write(DATA)
    with pytest.raises(RecordingError, match=rf"x.wav: .*{message}"):
        read(path)


def test_the_longest_comment_comes_back_and_a_longer_one_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    empty = len(json.dumps({"ctlblocks": 1, "names": ("a", "b"), "units": ("V", "V"), "provenance": {"log": ""}}))
    room = wav_file.LONGEST_COMMENT - empty
    write(path, recording(provenance={"log": "x" * room}))
    assert read(path).provenance == {"log": "x" * room}
    with pytest.raises(RecordingError, match=r"provenance take 50001 bytes, must be <= 50000"):
        write(path, recording(provenance={"log": "x" * (room + 1)}))
    assert read(path).provenance == {"log": "x" * room}


@pytest.mark.parametrize("rate", [44_100.5, 0.5, 2.0**31])
def test_a_rate_that_a_wav_cannot_say_is_refused(tmp_path: Path, rate: float) -> None:
    with pytest.raises(RecordingError, match=rf"2 channels at {rate} samples/s, must be <= 1024 at a whole number"):
        write(tmp_path / "x.wav", recording(rate=rate))
    assert list(tmp_path.iterdir()) == []


def test_1024_channels_go_into_a_wav_and_one_more_does_not(tmp_path: Path) -> None:
    def wide(channels: int) -> Recording:
        names = tuple(f"c{n}" for n in range(channels))
        return recording(names=names, units=("V",) * channels, data=np.zeros((3, channels)))

    write(tmp_path / "x.wav", wide(1024))
    assert read(tmp_path / "x.wav").names == wide(1024).names
    with pytest.raises(RecordingError, match="1025 channels at 44100.0 samples/s, must be <= 1024"):
        write(tmp_path / "x.wav", wide(1025))


def test_other_programs_read_what_is_written(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    write(path, recording(data=DATA.astype("float32")))
    info = soundfile.info(path)
    assert (info.format, info.subtype, info.samplerate, info.channels, info.frames) == ("WAV", "FLOAT", 44_100, 2, 20)
    samples, _ = soundfile.read(path, dtype="float32")
    assert np.array_equal(samples, DATA.astype("float32"))

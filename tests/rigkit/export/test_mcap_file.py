"""Recordings as MCAP, read back through the schemas that are in the file."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import Recording
from rigkit.export.mcap_file import BLOCK, field_names, write_mcap
from tests.rigkit.export.read_mcap import attachments, read_mcap


def noise(channels: int, dtype: str, rate: float) -> Recording:
    data = np.random.default_rng(channels).normal(size=(50, channels)).astype(dtype)
    data[0] = 0.0  # protobuf leaves out what is 0
    data[1] = np.finfo(dtype).tiny
    names = tuple(f"channel_{n + 1}" for n in range(channels))
    return Recording(names, tuple("V" if n else "m/s^2" for n in range(channels)), rate, data, {"rig": "x"})


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_every_sample_comes_back_to_its_last_bit_with_rate_and_units(tmp_path: Path, dtype: str) -> None:
    """Twenty channels: from the sixteenth on, the number of a field takes two bytes."""
    wanted = {"/a": noise(20, dtype, 44_100), "/b": noise(2, dtype, 250), "/c": noise(2, dtype, 440.5)}
    write_mcap(tmp_path / "x.mcap", wanted.items(), {"run": "x"})
    found = read_mcap(tmp_path / "x.mcap", dtype)
    assert found.keys() == wanted.keys()
    for topic, record in wanted.items():
        assert (found[topic].names, found[topic].units, found[topic].rate) == (record.names, record.units, record.rate)
        assert found[topic].data.tobytes() == record.data.tobytes()
        assert found[topic].provenance["rig"] == "x"


def test_files_go_along_whole(tmp_path: Path) -> None:
    (tmp_path / "config.toml").write_text("[rig]\n")
    write_mcap(tmp_path / "x.mcap", [("/a", noise(1, "float32", 10))], {}, [tmp_path / "config.toml"])
    assert attachments(tmp_path / "x.mcap") == {"config.toml": b"[rig]\n"}


def test_names_that_protobuf_cannot_tell_apart_are_refused() -> None:
    assert field_names(["x", "2nd", "å-b"]) == ["x", "_2nd", "__b"]
    with pytest.raises(ValueError, match="the channels a b, a-b become a_b, a_b, must differ"):
        field_names(["a b", "a-b"])


@pytest.mark.slow
def test_a_long_recording_takes_the_memory_of_a_block(tmp_path: Path) -> None:
    peaks = []
    for frames in (2 * BLOCK, 4 * BLOCK):  # more than the largest chunk of the file
        record = Recording(("a",), ("V",), 10_000.0, np.zeros((frames, 1), np.float32))
        tracemalloc.start()
        try:
            write_mcap(tmp_path / "x.mcap", [("/a", record)], {})
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    assert peaks[1] - peaks[0] < 2 * BLOCK * 8  # bytes a sample, for what the chunks differ by
    found = read_mcap(tmp_path / "x.mcap", "float32")["/a"]
    assert (len(found.data), found.rate) == (4 * BLOCK, 10_000.0)

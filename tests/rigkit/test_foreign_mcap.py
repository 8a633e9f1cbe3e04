"""MCAP logs of anybody's: numbers in their messages, times of their log, and what makes them unreadable, by name."""

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType, IndexType

from ctlblocks.recording import Recording, RecordingError
from rigkit.export.mcap_file import write_mcap
from rigkit.foreign_record import read_channels, read_signals
from tests.rigkit.mcap_logs import json_log, protobuf_log, ros2_log, times

RATE = 250.0
X = np.round(np.random.default_rng(3).normal(size=200), 6)


def force(count: int = 200, rate: float = RATE, start: float = 1.7e9) -> list[tuple[int, object]]:
    values = X[np.arange(count) % 200]
    return [
        (time, {"force": {"z": float(x)}, "k": n})
        for n, (time, x) in enumerate(zip(times(count, rate, start), values, strict=True))
    ]


def refused(path: Path, said: str, *channels: str, rate: float | None = None) -> None:
    with pytest.raises(RecordingError, match=said) as told:
        read_channels(path, channels, rate) if channels else read_signals(path, rate)
    assert "\n" not in str(told.value)
    assert str(told.value).startswith(str(path))


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"compression": CompressionType.LZ4, "chunk_size": 500},
        {"compression": CompressionType.NONE, "index_types": IndexType.NONE},
        {"use_chunking": False},
        {"use_chunking": False, "use_summary_offsets": False, "use_statistics": False, "repeat_channels": False},
    ],
)
def test_numbers_of_json_are_signals_at_the_rate_of_the_log(tmp_path: Path, options: dict[str, Any]) -> None:
    found = read_signals(json_log(tmp_path / "log.mcap", {"/ft": force()}, **options))
    assert (found.names, found.units) == (("/ft.force.z", "/ft.k"), ("1", "1"))
    assert found.rate == pytest.approx(RATE, rel=1e-12)
    np.testing.assert_array_equal(found.data, np.column_stack([X, np.arange(200)]))


def test_channels_come_in_the_order_that_is_asked(tmp_path: Path) -> None:
    long, short = (
        [(t, {"c": [1, n]}) for n, t in enumerate(times(9, 10.0))],
        [(t, {"b": {"c": [3]}}) for t in times(9, 10.0)],
    )
    path = json_log(tmp_path / "log.mcap", {"/a.b": long, "/a": short})
    found = read_channels(path, ["/a.b.c[1]", "/a.b.c.0"], None)
    assert found.names == ("/a.b.c.1", "/a.b.c.0")
    np.testing.assert_array_equal(found.data, np.column_stack([np.arange(9.0), np.ones(9)]))


def test_protobuf_is_decoded_by_the_schema_in_the_file(tmp_path: Path) -> None:
    path = protobuf_log(tmp_path / "log.mcap", list(X), 1000.0)
    names = ["/gauge.value", "/held.fields.list.list_value.values[1].number_value"]
    found = read_channels(path, names, None)
    assert found.rate == pytest.approx(1000.0)
    np.testing.assert_array_equal(found.data, np.column_stack([X, X]))
    assert "/held.fields.list.list_value.values.1.number_value" in read_signals(path).names


def test_ros_2_is_decoded_by_the_schema_in_the_file(tmp_path: Path) -> None:
    position = X.reshape(-1, 2)
    path = ros2_log(tmp_path / "log.mcap", position, 100.0)
    found = read_channels(path, ["/joint_states.position[1]", "/joint_states.effort[2]", "/joint_states.moving"], None)
    assert found.rate == pytest.approx(100.0)
    wanted = [position[:, 1], (4 * position[:, 0]).astype(np.float32), np.arange(100) % 2]
    np.testing.assert_array_equal(found.data, np.column_stack(wanted))
    assert read_signals(path).names[:3] == tuple(
        f"/joint_states.{name}" for name in ("header.stamp.sec", "header.stamp.nanosec", "position.0")
    )


def test_an_export_of_this_program_comes_back_bit_for_bit(tmp_path: Path) -> None:
    record = Recording(("x", "u"), ("m", "V"), 44_100.0, np.random.default_rng(1).standard_normal((5000, 2)))
    write_mcap(tmp_path / "made.mcap", [("/recording", record)], {})
    found = read_channels(tmp_path / "made.mcap", ["/recording.u", "/recording.x"], None)
    assert (found.units, found.rate) == (("V", "m"), 44_100.0)
    np.testing.assert_array_equal(found.data, record.data[:, ::-1])


def test_topics_are_laid_on_the_samples_that_both_have(tmp_path: Path) -> None:
    late = force(150, start=1.7e9 + 10.3 / RATE)
    path = json_log(tmp_path / "log.mcap", {"/ft": force(), "/late": late})
    found = read_channels(path, ["/ft.k", "/late.k"], None)
    np.testing.assert_array_equal(found.data, np.column_stack([np.arange(10, 160), np.arange(150)]))


def jittered(seconds: float, count: int = 200) -> list[tuple[int, object]]:
    late = np.random.default_rng(7).uniform(0, seconds * 1e9, count)
    return [(time + int(jitter), value) for (time, value), jitter in zip(force(count), late, strict=True)]


def test_times_that_jitter_by_less_than_half_a_sample_tell_the_rate(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": jittered(1.5e-3, 40)})
    found = read_channels(path, ["/ft.force.z"], None)
    assert found.rate != RATE
    assert found.rate == pytest.approx(RATE, rel=5e-3)
    np.testing.assert_array_equal(found.data[:, 0], X[:40])
    assert read_channels(path, ["/ft.force.z"], RATE).rate == RATE, "the rate that is said fits them as well"
    refused(path, "samples/s, --rate says 240", "/ft.force.z", rate=240.0)


def test_times_that_jitter_by_more_are_refused_with_the_jitter(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": jittered(6e-3)})
    refused(
        path, r"/ft was not logged evenly, .*: \d+ of 199 steps of time are off, .* to 0\.0\d+ s where most are 0\.00"
    )
    slow = [(time + round(5e-3 * 1e9 * np.sin(n / 30)), value) for n, (time, value) in enumerate(force())]
    refused(
        json_log(tmp_path / "slow.mcap", {"/ft": slow}), r"times are up to 0\.00\d+ s off those of 2\d\d\.\d+ samples/s"
    )


def test_a_lost_message_is_refused_by_its_number(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": [each for n, each in enumerate(force()) if n != 120]})
    refused(
        path, r"1 of 198 steps of time are off, 0\.004 to 0\.008 s where most are 0\.004 s, the first to message 121"
    )


def test_several_rates_are_refused_by_name_unless_one_is_asked_for(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": force(), "/slow": force(100, 125.0), "/drift": force(200, 249.0)})
    refused(path, "/slow has 125 samples/s, /ft 250; columns must have one rate", "/ft.k", "/slow.k")
    refused(path, "/drift has 249 samples/s, /ft 250; columns must have one rate", "/ft.k", "/drift.k")
    assert read_channels(path, ["/slow.k"], None).rate == pytest.approx(125.0)
    refused(path, "125 samples/s, --rate says 250", "/slow.k", rate=250.0)


def test_topics_that_do_not_overlap_are_refused(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/a": force(20), "/b": force(20, start=1.7e9 + 1)})
    refused(path, "/a, /b were logged one after the other", "/a.k", "/b.k")


@pytest.mark.parametrize(
    ("channel", "said"),
    [
        ("/fft.k", "no channel '/fft.k', must be TOPIC.FIELD or TOPIC.FIELD.NUMBER.; topics are /ft, /text"),
        ("1", "no channel '1', must be TOPIC.FIELD"),
        ("/ft", "no channel '/ft', must be TOPIC.FIELD"),
        ("/ft.k[", "no channel '/ft.k.', must be TOPIC.FIELD"),
        ("/ft.q", "/ft has no number q in message 1; there are force.z, k"),
        ("/ft.force", "/ft has no number force in message 1; there are force.z, k"),
        ("/ft.k.real", "/ft has no number k.real in message 1"),
        ("/ft.force[2]", "/ft has no number force.2 in message 1"),
        ("/text.a", "/text has no number a in message 1; there are none"),
    ],
)
def test_what_is_not_there_is_named(tmp_path: Path, channel: str, said: str) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": force(), "/text": [(time, {"a": "b"}) for time in times(9, 10.0)]})
    refused(path, said, channel)


@pytest.mark.parametrize(
    ("last", "said"),
    [
        ({"a": [1, 2]}, r"/x has no number a.2 in message 10; there are a.0, a.1"),
        ({"a": [1, 2, None]}, r"/x has no number a.2 in message 10"),
        ({"a": [1, 2, float("nan")]}, r"channel '/x.a.2', sample 9: nan, must be finite"),
        ({"a": [1, 2, 10**400]}, r"/x has no number a.2 in message 10"),
    ],
)
def test_a_message_without_the_number_is_told(tmp_path: Path, last: object, said: str) -> None:
    messages = [(time, {"a": [1, 2, 3]} if n < 9 else last) for n, time in enumerate(times(10, 10.0))]
    refused(json_log(tmp_path / "log.mcap", {"/x": messages}), said, "/x.a[2]")


def test_another_encoding_is_refused_by_its_name(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": force()}, encoding="cbor")
    refused(path, "/ft is encoded as 'cbor', must be json, protobuf, or cdr with a ros2msg schema", "/ft.k")


def test_an_image_in_numbers_must_be_asked_for_by_number(tmp_path: Path) -> None:
    path = json_log(tmp_path / "log.mcap", {"/image": [(time, list(range(2000))) for time in times(3, 10.0)]})
    refused(path, "/image has more than 1000 numbers, must be named")
    assert read_channels(path, ["/image[1999]"], None).data[0, 0] == 1999


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    whole = json_log(path, {"/ft": force()}).read_bytes()
    for content in (b"", whole[:4], whole[:60], whole[: len(whole) // 2], whole[:-9], b"RIFF" + whole):
        path.write_bytes(content)
        refused(path, r"not a readable MCAP file, it is damaged or cut short \(.+\)")
    changed = bytearray(whole)
    changed[len(whole) // 3] ^= 1
    path.write_bytes(changed)
    refused(path, "not a readable MCAP file")
    refused(json_log(path, {}), "holds no message with a number")
    refused(json_log(path, {"/ft": []}), "/ft has 0 messages, must have at least 2", "/ft.k")
    refused(json_log(path, {"/ft": force(1)}), "/ft has 1 messages, must have at least 2 to tell the rate")


def test_a_package_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = json_log(tmp_path / "log.mcap", {"/ft": force()})
    there = importlib.import_module

    def missing(name: str) -> object:
        if name == "mcap_ros2.decoder":
            raise ImportError("No module named 'mcap_ros2'")
        return there(name)

    monkeypatch.setattr("rigkit.export.optional.importlib.import_module", missing)
    with pytest.raises(
        ValueError, match=r"needs mcap_ros2.decoder, which is not there .* pip install 'vibrostage\[export\]'"
    ):
        read_signals(path)

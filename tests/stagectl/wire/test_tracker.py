"""The tracker's packets: there and back, cut anywhere, and rubbish between them."""

import numpy as np
import pytest

from rigkit.wire.layout import WireError
from stagectl.wire.tracker import Packets, Sample, Sighting, pack_sample

POSE = np.array([0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0])


def sample(counter: int) -> Sample:
    return Sample(
        counter, 0.002 * counter, (Sighting(7, 3, 1e-4, POSE + counter), Sighting(1, 0, np.nan, POSE * np.nan))
    )


def test_samples_come_out_whole_however_the_stream_is_cut() -> None:
    stream = b"".join(pack_sample(sample(n)) for n in range(5))
    for size in (1, 7, 60, 1_000):
        packets = Packets()
        found = [each for at in range(0, len(stream), size) for each in packets.take(stream[at : at + size])]
        assert [each.counter for each in found] == list(range(5))
        assert found[3].time == pytest.approx(0.006)
        np.testing.assert_array_equal(found[3].sightings[0].pose, POSE + 3)
        assert np.isnan(found[3].sightings[1].pose).all()
        assert packets.garbled == 0


def test_rubbish_is_counted_and_the_next_sample_found() -> None:
    packets, good = Packets(), pack_sample(sample(1))
    damaged = bytearray(good)
    damaged[40] ^= 1
    wrong_size = good[:4] + b"\xff\xff" + good[6:]
    found = packets.take(b"noise" + bytes(damaged) + wrong_size + good + b"TR")
    assert [each.counter for each in found] == [1]
    assert packets.garbled >= 3
    assert [each.counter for each in packets.take(good[2:] + good)] == [1, 1]


def test_too_many_frames_are_refused() -> None:
    with pytest.raises(WireError, match="65 frames, must be at most 64"):
        pack_sample(Sample(1, 0.0, (Sighting(1, 3, 0.0, POSE),) * 65))

"""What the frames cost of the bus."""

import pytest

from rigkit.config import load
from stagectl.config import StageConfig
from stagectl.wire import messages
from stagectl.wire.bus_load import frame_time, least_load


def test_a_classic_frame_of_8_bytes_has_at_most_135_bits() -> None:
    """The bound that every account of CAN's timing gives."""
    assert frame_time(messages.COMMAND, 500_000, 1) == pytest.approx(135 / 500_000)


def test_an_fd_frame_is_mostly_data() -> None:
    time = frame_time(messages.POSITION, 500_000, 2_000_000)
    assert time == pytest.approx(34 / 500_000 + 678 / 2_000_000)


@pytest.mark.parametrize(
    ("form", "bitrate", "data_bitrate", "percent"),
    [
        ("fd", 1_000_000, 5_000_000, 39),
        ("fd", 500_000, 2_000_000, 92),
        ("classic", 1_000_000, 5_000_000, 32),
        ("classic", 500_000, 5_000_000, 65),
        ("classic", 250_000, 5_000_000, 130),
    ],
)
def test_the_load_is_that_of_streams_and_heartbeats(form: str, bitrate: int, data_bitrate: int, percent: float) -> None:
    assert 100 * least_load(form, bitrate, data_bitrate) == pytest.approx(percent, abs=0.7)


def test_a_bus_that_is_too_slow_is_refused() -> None:
    with pytest.raises(ValueError, match="too slow for link.form classic: the bus would be busy for 130 %"):
        load(None, StageConfig, ["link.form=classic", "link.bitrate=250000"])

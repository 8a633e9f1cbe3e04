"""Two signals on one channel are refused, by the names of both keys."""

import pytest

from rigkit import config as rig_file
from rigkit.config import ConfigError
from vibractl.audio_stream import channels
from vibractl.config import RigConfig

FOUR = ("audio.drive_channels=[1,2,3,4]", "audio.response_channels=[1,2,3,4]")


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (FOUR[:1], r"drive_channels \[1, 2, 3, 4\] and audio.loopback_output 3 share output 3, must be different"),
        (
            (*FOUR, "audio.loopback_output=5"),
            r"response_channels \[1, 2, 3, 4\] and audio.loopback_input 3 share input 3",
        ),
        (("audio.far_field_channels=[4,3]",), r"far_field_channels \[4, 3\] and audio.loopback_input 3 share input 3"),
        (
            ("audio.far_field_channels=[2]",),
            r"response_channels \[1, 2\] and audio.far_field_channels \[2\] share input 2",
        ),
        (("audio.far_field_channels=[4,4]",), r"audio.far_field_channels \[4, 4\] share input 4"),
        (("audio.drive_channels=[2,2]",), r"audio.drive_channels \[2, 2\] share output 2"),
        (("audio.far_field_channels=[0]",), r"audio.far_field_channels has 0, must be 1 to 64"),
        (("audio.far_field_channels=[65]",), r"audio.far_field_channels has 65, must be 1 to 64"),
    ],
)
def test_a_channel_that_two_signals_want_is_refused_by_both_keys(settings: tuple[str, ...], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        rig_file.load(None, RigConfig, settings)


def test_the_loopback_channels_are_free_where_there_is_no_cable() -> None:
    rig_file.load(None, RigConfig, (*FOUR, "audio.alignment=marker"))


def test_a_drive_and_a_response_may_have_the_same_number_and_the_far_field_needs_inputs() -> None:
    config = rig_file.load(
        None, RigConfig, (*FOUR, "audio.loopback_output=5", "audio.loopback_input=5", "audio.far_field_channels=[9,6]")
    )
    assert channels(config.audio) == (9, 5)

"""What an edit of a rig file touches."""

from pydantic import Field

from rigkit.config import Section, setting
from rigkit.service.reload import Reach, change


class Audio(Section):
    """A table."""

    rate: int = setting(44_100, "1/s", "rate")
    attempts: int = setting(3, "", "attempts")


class Rig(Section):
    """A rig file."""

    audio: Audio = Field(default_factory=Audio)
    shots: int = setting(30, "shots", "shots")
    options: dict[str, float] = setting({}, "", "options")


REACHES = {"audio": Reach.DEVICES, "audio.attempts": Reach.PARAMETERS, "shots": Reach.PARAMETERS}


def test_nothing_has_changed_where_every_value_is_the_same() -> None:
    found = change(Rig(), Rig(), REACHES)
    assert (found.reach, dict(found.keys)) == (Reach.NOTHING, {})


def test_a_key_counts_for_itself_before_its_table_does() -> None:
    new = Rig(audio=Audio(attempts=5), shots=10)
    assert change(Rig(), new, REACHES).keys == {"audio.attempts": Reach.PARAMETERS, "shots": Reach.PARAMETERS}
    assert change(Rig(), Rig(audio=Audio(rate=48_000)), REACHES).reach is Reach.DEVICES


def test_what_nobody_has_named_is_built_anew() -> None:
    assert change(Rig(), Rig(options={"gain": 1.0}), REACHES).keys == {"options.gain": Reach.GRAPH}


def test_the_deepest_counts() -> None:
    new = Rig(audio=Audio(rate=48_000), shots=10, options={"a": 1.0})
    assert change(Rig(), new, REACHES).reach is Reach.DEVICES

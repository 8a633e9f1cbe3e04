"""What an edit of a rig file touches."""

from pydantic import Field

from rigkit.config import Section, setting
from rigkit.config_fault import ConfigError
from rigkit.service.config import Daemon
from rigkit.service.reload import Reach, change, edits


class Audio(Section):
    """A table."""

    rate: int = setting(44_100, "1/s", "rate")
    attempts: int = setting(3, "", "attempts")


class Rig(Section):
    """A rig file."""

    audio: Audio = Field(default_factory=Audio)
    daemon: Daemon = Field(default_factory=Daemon)
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


def test_an_edit_since_it_was_read_is_told_with_both_values_and_the_way_out() -> None:
    told = edits(Rig(), Rig(), lambda: Rig(shots=10, options={"gain": 1.0}))
    assert "(options.gain not there -> 1.0, shots 30 -> 10)" in told
    assert told.endswith("what was read before holds; a reload takes up the edit")


def test_no_edit_and_one_that_holds_already_are_not_told() -> None:
    assert not edits(Rig(shots=10), Rig(shots=10), lambda: Rig(shots=10))
    assert not edits(Rig(), Rig(shots=10), lambda: Rig(shots=10))  # as a calibration has written it
    assert not edits(Rig(), Rig(shots=10), Rig)  # what a calibration has changed is no edit


def test_an_edit_that_is_wrong_is_told_and_refuses_nothing() -> None:
    def load() -> Rig:
        raise ConfigError("rig.toml: shots is -1, must be > 0")

    assert "is wrong now: rig.toml: shots is -1, must be > 0; what was read before holds" in edits(Rig(), Rig(), load)

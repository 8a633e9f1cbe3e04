"""One comparison with three verdicts: same, different without harm, different and refused until it is accepted."""

from pathlib import Path

import pytest

from rigkit.agreement import (
    GOING_ON,
    MEASURED_ELSEWHERE,
    DisagreementError,
    accepted,
    agreed,
    changed_parts,
    differences,
)
from rigkit.config_role import role_at
from rigkit.origin import RUN, Origin, OriginError, checksum, flat, read_origin
from rigkit.run_folder import RunFolder, read_events
from rigkit.run_origin import changed, going_on, keep_origin
from vibractl.config import RigConfig


def rig(**tables: dict[str, object]) -> RigConfig:
    """Return settings with some keys other than their defaults."""
    return RigConfig.model_validate(tables)


def told(found: list[object]) -> list[tuple[str, bool]]:
    """Return which keys differ, and which of them do harm."""
    return [(each.key, each.is_harmful) for each in found]  # type: ignore[attr-defined]


def test_each_key_has_the_role_of_its_table_unless_it_declares_one() -> None:
    assert role_at(RigConfig, ["audio", "input_full_scale"]) == "wiring"
    assert role_at(RigConfig, ["audio", "blocksize"]) == "patience"
    assert role_at(RigConfig, ["audio", "relay", "bus"]) == "patience"
    assert role_at(RigConfig, ["learning", "law"]) == "experiment"
    assert role_at(RigConfig, ["simulator", "options", "seed"]) == "plant"
    assert role_at(RigConfig, ["simulator", "speed"]) == "patience"
    assert role_at(RigConfig, ["audio", "nothing"]) is None


def test_a_model_is_spoilt_by_another_wiring_and_not_by_another_experiment() -> None:
    before = rig().model_dump(mode="json")
    now = rig(
        audio={"input_full_scale": 40.0, "blocksize": 64},
        learning={"law": "thesis"},
        simulator={"options": {"seed": 3}},
    )
    found = differences(before, now, MEASURED_ELSEWHERE)
    assert told(found) == [("audio.input_full_scale", True), ("simulator.options.seed", False)]


def test_what_goes_on_may_change_in_its_patience_alone() -> None:
    before = rig().model_dump(mode="json")
    now = rig(audio={"attempts": 9}, limits={"peak": 5.0}, characterisation={"probe": 0.2})
    assert told(differences(before, now, GOING_ON)) == [
        ("audio.attempts", False),
        ("limits.peak", True),
        ("characterisation.probe", True),
    ]
    assert told(differences(before, now, GOING_ON.without("characterisation", "limits.peak"))) == [
        ("audio.attempts", False)
    ]


def test_a_key_that_the_older_program_did_not_know_is_not_compared() -> None:
    before = rig().model_dump(mode="json")
    del before["audio"]["alignment"]
    assert not differences(before, rig(audio={"alignment": "marker"}), MEASURED_ELSEWHERE)


def test_an_option_that_is_gone_or_new_differs() -> None:
    before = rig(simulator={"options": {"seed": 3}})
    found = differences(before.model_dump(mode="json"), rig(simulator={"options": {"noise": 1}}), GOING_ON)
    assert {(each.key, each.before, each.now) for each in found} == {
        ("simulator.options.seed", 3, None),
        ("simulator.options.noise", None, 1),
    }


def test_a_refusal_names_key_values_the_way_out_and_how_to_accept() -> None:
    found = differences(rig().model_dump(mode="json"), rig(audio={"rate": 48_000}), MEASURED_ELSEWHERE)
    with pytest.raises(
        DisagreementError,
        match=r"m.h5 is of another: audio.rate was 44100, is 48000; measure again, .* with --accept audio.rate$",
    ):
        agreed(found, [], "m.h5 is of another", "measure again")


def test_what_is_accepted_is_said_and_what_accepts_nothing_as_well() -> None:
    found = differences(rig().model_dump(mode="json"), rig(audio={"rate": 48_000}), MEASURED_ELSEWHERE)
    notes = agreed(found, ["audio.rate", "audio.device"], "m.h5", "measure again")
    assert notes == ["m.h5: audio.rate was 44100, is 48000; accepted", "--accept audio.device: nothing differs there"]
    assert accepted(found, ["audio.rate", "audio.device"]) == ["audio.rate"]


def test_parts_are_compared_by_their_bytes(tmp_path: Path) -> None:
    (tmp_path / "model.h5").write_bytes(b"one")
    origin = Origin.of("run", rig(), {"model.h5": tmp_path / "model.h5"})
    assert not changed_parts(origin, {"model.h5": checksum(tmp_path / "model.h5")})
    (tmp_path / "model.h5").write_bytes(b"two")
    assert told(changed_parts(origin, {"model.h5": checksum(tmp_path / "model.h5")})) == [("model.h5", True)]
    assert [each.now for each in changed_parts(origin, {})] == [None]


def test_a_run_tells_what_it_began_with_and_keeps_what_was_accepted(tmp_path: Path) -> None:
    with RunFolder.filled(tmp_path / "run", "") as folder:
        folder.write("model.h5", b"one")
        keep_origin(folder, "vibrator run", rig(), ["model.h5"], [])
    folder.close()
    origin = read_origin(tmp_path / "run" / RUN)
    assert origin is not None
    assert (origin.kind, origin.settings) == ("vibrator run", rig().model_dump(mode="json"))
    louder = rig(limits={"peak": 8.0})
    with RunFolder.open(tmp_path / "run") as folder:
        with pytest.raises(DisagreementError, match=r"limits.peak was 9.0, is 8.0"):
            going_on(folder, louder, [])
        assert len(going_on(folder, louder, ["limits.peak"])) == 1
        assert going_on(folder, louder, []) == []
    assert changed(tmp_path / "run", louder) == []
    assert read_events(tmp_path / "run")[-1]["keys"] == ["limits.peak"]


def test_a_folder_without_a_record_says_so(tmp_path: Path) -> None:
    with RunFolder.filled(tmp_path / "run", "") as folder:
        assert "does not say what it began with" in going_on(folder, rig(), [])[0]


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 2}', '{"schema": 1, "kind": 3}'])
def test_a_record_that_cannot_be_read_is_refused_by_name(tmp_path: Path, text: str) -> None:
    (tmp_path / RUN).write_text(text)
    with pytest.raises(OriginError, match=RUN):
        read_origin(tmp_path / RUN)


def test_the_configuration_in_a_models_words_is_its_origin() -> None:
    origin = Origin.told("model", {"config": "[rig]\nname = 'A'\n", "date": "2026-01-02T03:04:05+00:00"}, "m.h5")
    assert origin is not None
    assert flat(origin.settings) == {"rig.name": "A"}
    assert origin.measured == "2026-01-02T03:04:05+00:00"
    assert Origin.told("model", {}, "m.h5") is None
    with pytest.raises(OriginError, match="m.h5: the configuration it was made with is not TOML"):
        Origin.told("model", {"config": "rig = ["}, "m.h5")

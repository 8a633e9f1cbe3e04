"""A run or a calibration for which the disk has no room does not begin: nothing is emitted, the rig stays armed.

One whose disk fills up while it runs is a fault, which says where there is no room, and how much there was wanted.
"""

import re
from pathlib import Path

import pytest

from ctlblocks.room import free
from rigkit.service.state import State
from tests.rigkit.small_disk import full
from tests.rigkit.test_disk_space import leave
from tests.vibractl.daemon.bench import Lab, lab_in
from vibractl.audio import Line
from vibractl.daemon import running

OPTIONS = {"run": {"run": "one"}, "calibrate": {"model": "found.h5"}}


def refused(lab: Lab, procedure: str, **options: object) -> str:
    """Begin it; return why it has not begun, with the rig armed and the data folder as it was."""
    before = sorted(lab.data.rglob("*"))
    lab.begin(procedure, **options)
    lab.ended()
    lab.control.journal.close()
    after = [path for path in sorted(lab.data.rglob("*")) if path.name != "events.jsonl"]
    assert after == [path for path in before if path.name != "events.jsonl"]
    assert lab.state is State.ARMED, lab.control.machine.last.why
    why: str = lab.events("end")[-1]["why"]
    return why


@pytest.mark.parametrize("procedure", OPTIONS)
def test_what_the_disk_has_no_room_for_does_not_begin(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Line, "__enter__", lambda _: pytest.fail("the line was opened"))
    lab = lab_in(tmp_path)
    lab.control.arm(lab.key, "a test")
    leave(70e6, monkeypatch)
    why = refused(lab, procedure, **OPTIONS[procedure])
    assert "has not begun: " in why
    assert "70 MB are free and 67.11 MB of it stay so" in why


@pytest.mark.slow
def test_a_run_that_goes_on_wants_room_for_the_shots_that_are_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab = lab_in(tmp_path)
    lab.begin("run", run="one", shots=2)
    lab.ended()
    assert lab.state is State.ARMED
    leave(67.2e6, monkeypatch)
    why = refused(lab, "run", run="one", shots=400, resume=True)
    assert "398 shots of " in why


@pytest.mark.sample(1)
@pytest.mark.parametrize("procedure", OPTIONS)
def test_a_disk_that_fills_up_meanwhile_is_a_fault_that_names_file_folder_and_room_and_the_run_goes_on(
    procedure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running, "run_report", lambda _: None)
    with full(tmp_path, 300_000_000) as (folder, why):
        lab = lab_in(folder)
        lab.control.arm(lab.key, "a test")
        opened, filler = Line.__enter__, folder / "filler"

        def fill_up(line: Line) -> Line:
            filler.write_bytes(bytes(free(folder) - 100_000))
            return opened(line)

        monkeypatch.setattr(Line, "__enter__", fill_up)
        lab.begin(procedure, **{**OPTIONS[procedure], "shots": 2} if procedure == "run" else OPTIONS[procedure])
        lab.ended()
        assert lab.state is State.FAULT
        file, left = rf"{lab.data}/\S+", r"[\d.]+ MB"
        told = f"{file}: {why}: {left} are free in {file}/, {left} are wanted"
        assert re.fullmatch(told, lab.control.machine.last.why)
        monkeypatch.setattr(Line, "__enter__", opened)
        filler.unlink()
        lab.control.acknowledge(lab.key, "there is room again")
        again = {**OPTIONS[procedure], "shots": 2, "resume": (lab.data / "runs" / "one").exists()}
        lab.begin(procedure, **again if procedure == "run" else OPTIONS[procedure])
        lab.ended()
        assert lab.state is State.ARMED, lab.control.machine.last.why
        lab.control.close(60)
        lab.control.journal.close()

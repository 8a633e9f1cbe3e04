"""Commands on a rig: who may, when, and what becomes of the output."""

import errno
import threading
from typing import Any

import pytest

from rigkit.service.lease import Refused
from rigkit.service.not_begun import making
from rigkit.service.reload import Change, Reach
from rigkit.service.rig import Desk
from rigkit.service.state import NotNow, State
from tests.rigkit.service.conftest import Bench
from tests.until import EVER, until

LONG = {"steps": 100_000, "seconds": 10.0}


def test_a_procedure_runs_to_its_end_and_leaves_the_rig_armed(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=3, seconds=0.0)
    bench.ended()
    assert (bench.state, bench.rig.output) == (State.ARMED, 0.0)
    assert bench.events() == ["control", "arm", "run", "step", "step", "step", "end"]
    assert bench.control.board.panel("convergence")["traces"][0]["x"].tolist() == [0, 1, 2]


def test_panels_stay_when_a_procedure_has_ended_and_go_when_another_begins(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=2, seconds=0.0)
    bench.ended()
    before = bench.control.board.revisions()
    bench.begin("measure", **LONG)
    assert bench.control.board.revisions() == {}
    bench.control.stop("Bob", "")
    bench.ended()
    bench.arm()
    bench.begin(steps=1, seconds=0.0)
    bench.ended()
    after = bench.control.board.revisions()
    assert after.keys() == before.keys()
    assert min(after.values()) > max(before.values())  # none is taken for one that was fetched before


def test_a_rig_file_edited_since_it_was_read_is_said_before_anything_is_done(bench: Bench) -> None:
    bench.arm()
    bench.rig.edited = "the rig file was edited"
    bench.begin(steps=1, seconds=0.0)
    bench.ended()
    assert bench.events() == ["control", "arm", "run", "note", "step", "end"]


def test_a_calibration_is_a_state_of_its_own_and_cannot_be_held(bench: Bench) -> None:
    bench.arm()
    bench.begin("measure", **LONG)
    assert bench.state is State.CALIBRATING
    with pytest.raises(NotNow, match="cannot hold now: Measurement cannot be paused"):
        bench.control.hold(bench.key, "")
    assert bench.state is State.CALIBRATING


def test_stop_needs_no_lease_and_brings_the_output_to_zero_before_it_returns(bench: Bench) -> None:
    bench.arm()
    bench.begin(**LONG)
    until(lambda: bench.rig.output)
    bench.control.stop("Bob", "smoke")
    assert (bench.state, bench.rig.output) == (State.DISARMED, 0.0)
    bench.ended()
    until(lambda: not bench.rig.armed)
    assert bench.control.machine.last.why == "smoke"


def test_stop_waits_for_no_command_that_hangs(bench: Bench) -> None:
    """An arm that never comes back holds the commands up, and not the STOP."""
    entered, leave = threading.Event(), threading.Event()

    def hang() -> None:
        entered.set()
        leave.wait(EVER)

    bench.rig.arm = hang  # type: ignore[method-assign]
    refused: list[Exception] = []

    def arm() -> None:
        try:
            bench.arm()
        except NotNow as fault:
            refused.append(fault)

    arming = threading.Thread(target=arm)
    arming.start()
    entered.wait(EVER)
    bench.rig.output = 1.0
    bench.control.stop("Bob", "")
    assert bench.rig.output == 0.0
    leave.set()
    arming.join()
    assert "the rig was stopped meanwhile" in str(refused[0])
    assert bench.state is State.DISARMED


def test_what_had_been_armed_is_given_up_on_a_stop(bench: Bench) -> None:
    bench.arm()
    bench.control.stop("Bob", "")
    assert not bench.rig.armed


def test_a_step_that_begins_in_the_moment_of_a_stop_is_stopped_too(bench: Bench) -> None:
    """The rig may have looked at `ending` just before; `settle` comes with each snapshot."""
    bench.arm()
    bench.begin(**LONG)
    until(lambda: bench.rig.output)
    bench.control._desk().ending = lambda: False  # type: ignore[method-assign]  # noqa: SLF001  # it does not look
    bench.control.stop("Bob", "")
    until(lambda: bench.rig.output)  # the next step has begun all the same
    bench.control.settle()
    assert bench.rig.output == 0.0
    del bench.control._desk().ending  # noqa: SLF001
    until(lambda: bench.control.settle() or not bench.control.machine.busy)


@pytest.mark.parametrize(
    "refused",
    [ValueError("no model"), FileNotFoundError("no model"), PermissionError("no model")]
    + [OSError(number, "no model") for number in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)],
)
def test_a_procedure_that_is_refused_while_it_is_made_has_not_begun_and_the_rig_stays_armed(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, refused: Exception
) -> None:
    def run(desk: Desk, _: object) -> None:
        with making(desk):
            raise refused

    monkeypatch.setattr(bench.rig, "_run", run)
    bench.arm()
    number = bench.begin()["number"]
    bench.ended()
    assert (bench.state, bench.control.machine.last.why) == (State.ARMED, "Demonstration has not begun: no model")
    assert bench.rig.armed
    until(lambda: bench.control.begun(number) == {"outcome": "not begun", "why": "no model"})


@pytest.mark.parametrize("cause", [None, OSError(5, "Input/output error")])
def test_what_the_system_fails_at_while_a_procedure_is_made_is_a_fault(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, cause: OSError | None
) -> None:
    def run(desk: Desk, _: object) -> None:
        with making(desk):
            if cause is not None:
                raise ValueError("/data: Input/output error") from cause
            raise OSError(5, "Input/output error", "/data")

    monkeypatch.setattr(bench.rig, "_run", run)
    bench.arm()
    bench.begin()
    bench.ended()
    assert (bench.state, bench.control.machine.last.why) == (State.FAULT, "/data: Input/output error")


def test_a_procedure_that_breaks_is_a_fault_that_somebody_must_acknowledge(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=5, seconds=0.0, breaks_at=2)
    bench.ended()
    assert (bench.state, bench.control.machine.last.why) == (State.FAULT, "the bench has broken")
    until(lambda: not bench.rig.armed)
    with pytest.raises(NotNow, match="cannot arm now: the rig is FAULT, must be DISARMED"):
        bench.arm()
    with pytest.raises(ValueError, match="must say why"):
        bench.control.acknowledge(bench.key, "")
    bench.control.acknowledge(bench.key, "a cable was loose")
    assert (bench.state, bench.rig.acknowledged_by) == (State.DISARMED, "Ada")


def test_a_rig_that_cannot_be_armed_says_why_and_stays_disarmed(bench: Bench) -> None:
    bench.rig.refuses_to_arm = "the disk has 3 MB left, must have 100"
    with pytest.raises(ValueError, match="the disk has 3 MB left"):
        bench.arm()
    assert bench.state is State.DISARMED


def test_a_procedure_pauses_and_goes_on_where_it_was(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=2000, seconds=0.0)
    until(lambda: "step" in bench.events())
    bench.control.hold(bench.key, "lunch")
    until(lambda: bench.control.desk is not None and not bench.control.desk.is_recording)
    held = bench.control._desk().plain()["done"]  # noqa: SLF001
    assert bench.state is State.HOLD
    assert bench.rig.output == 0.0
    bench.control.resume(bench.key, "back")
    until(lambda: bench.control.desk is None or bench.control.desk.plain()["done"] > held)


def test_an_abort_ends_a_procedure_that_runs_or_is_held(bench: Bench) -> None:
    for held in (False, True):
        if not held:
            bench.arm()
        bench.begin(steps=100_000, seconds=0.0)
        if held:
            bench.control.hold(bench.key, "")
        bench.control.abort(bench.key, "enough")
        bench.ended()
        assert bench.state is State.ARMED


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"steps": 0}, "steps is 0, must be >= 1 and <= 100000 steps"),
        ({"steps": True}, "steps is true, must be a whole number"),
        ({"stepps": 3}, "has no stepps; did you mean steps"),
        ({"seconds": "long"}, "must be a number"),
    ],
)
def test_an_option_that_is_not_as_it_must_be_begins_nothing(bench: Bench, options: dict[str, Any], text: str) -> None:
    bench.arm()
    with pytest.raises(ValueError, match=text):
        bench.begin(**options)
    assert bench.state is State.ARMED


def test_a_procedure_that_there_is_not_is_refused_by_name(bench: Bench) -> None:
    with pytest.raises(LookupError, match="no procedure 'fly'; there are demonstrate, measure"):
        bench.begin("fly")


@pytest.mark.parametrize("command", ["arm", "disarm", "hold", "resume", "abort", "acknowledge"])
def test_no_command_without_the_lease(bench: Bench, command: str) -> None:
    with pytest.raises(Refused, match="Ada has control"):
        getattr(bench.control, command)("another key", "why not")
    assert bench.state is State.DISARMED


def test_taking_over_is_in_the_log(bench: Bench) -> None:
    with pytest.raises(Refused):
        bench.control.take_control("Bob", over=False)
    bench.control.take_control("Bob", over=True)
    assert bench.control.journal.since(0)[-1] | {"time": ""} == {
        "number": 2,
        "time": "",
        "event": "control taken over",
        "who": "Bob",
        "from": "Ada",
    }
    with pytest.raises(Refused, match="Bob has control"):
        bench.arm()


def test_a_reload_tells_how_deep_it_went(bench: Bench) -> None:
    bench.rig.change = Change({"audio.device": Reach.DEVICES, "session.shots": Reach.PARAMETERS}, "reopened")
    told = bench.control.reload(bench.key)
    assert told == {"reach": "devices", "keys": ["audio.device", "session.shots"], "done": "reopened"}
    assert bench.events()[-1] == "reload"


def test_a_procedure_that_is_ending_cannot_be_paused(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=100_000, seconds=0.3)
    bench.control.abort(bench.key, "enough")
    with pytest.raises(NotNow, match="cannot hold now"):
        bench.control.hold(bench.key, "")
    bench.ended()
    assert bench.state is State.ARMED

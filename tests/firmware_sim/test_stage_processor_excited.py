"""The stage's processor while an axis is excited: what it takes, sends and refuses, and how it leaves that mode."""

import numpy as np
import pytest

from stagectl.wire import messages
from stagectl.wire.messages import Command, Drive, Fault, HostState, Result, State
from tests.firmware_sim.processor_bench import Bench

VOLTAGE_OF_Y = 256 * Drive.VOLTAGE + 1


def excited() -> Bench:
    bench = Bench(silence=0.02, hold=0.0)
    assert bench.ask(Command.EXCITE, VOLTAGE_OF_Y)[1] == Result.DONE
    assert bench.excited == (Drive.VOLTAGE, 1)
    bench.stream(60, 4.0, layout=messages.VOLTAGE_DRIVE)
    assert bench.processor.state is State.EXCITED
    return bench


def test_an_excitation_is_played_once_as_much_waits_as_the_host_may_be_silent_twice() -> None:
    bench = excited()
    played = [block for block in bench.references if block.any()]
    assert len(played) == 60 - 40 + 1
    assert (played[-1] == 4.0).all()


def test_extension_and_voltage_of_every_block_are_sent_until_it_is_left() -> None:
    bench = excited()
    bench.frames.clear()
    bench.stream(20, 4.0, layout=messages.VOLTAGE_DRIVE)
    for layout in (messages.POSITION, messages.EXTENSION, messages.VOLTAGE):
        assert len(bench.said(layout)) == 20
    bench.ask(Command.STOP)
    bench.step(0.2)
    bench.frames.clear()
    bench.step(0.02)
    assert (len(bench.said(messages.POSITION)), len(bench.said(messages.VOLTAGE))) == (20, 2)


def test_the_status_says_which_reference_is_played_and_how_long_the_host_was_silent() -> None:
    bench = excited()
    bench.now += 0.015
    bench.stream(50, 4.0, layout=messages.VOLTAGE_DRIVE)
    _, block, *_, reference, waiting, silence, state, fault = bench.said(messages.STATUS)[-1]
    played = block - 1 - reference + waiting
    bench.stream(100, 4.0, layout=messages.VOLTAGE_DRIVE)
    _, block, *_, reference, waiting, silence, state, fault = bench.said(messages.STATUS)[-1]
    assert (block - 1 - reference + waiting, state, fault) == (played, State.EXCITED, Fault.NONE)
    assert 0 < waiting <= 40
    assert silence == pytest.approx(160, abs=1)


def test_stop_ramps_it_to_rest_closes_the_loops_and_it_holds() -> None:
    bench = excited()
    assert bench.ask(Command.STOP)[1] == Result.DONE
    assert (bench.processor.state, bench.excited) == (State.RAMPING, (Drive.VOLTAGE, 1))
    bench.step(0.15)
    assert (bench.processor.state, bench.excited) == (State.HOLDING, None)
    way = np.vstack(bench.references)[-1500:, 0]
    assert np.abs(np.diff(way)).max() < 4.0 * np.pi / 2 / 1000 * 1.01
    assert bench.references[-1].max() == 0.0
    assert bench.ask(Command.START)[1] == Result.DONE


@pytest.mark.parametrize(
    ("says", "fault"),
    [(None, Fault.HOST_SILENT), (HostState.FAULT, Fault.HOST_FAULT), (HostState.STREAMING, Fault.REFERENCE_SILENT)],
)
def test_a_host_that_is_lost_ends_it_at_rest_with_closed_loops(says: HostState | None, fault: Fault) -> None:
    bench = excited()
    for _ in range(200):
        if says is not None:
            bench.say(messages.HOST_HEARTBEAT, says, 0, 0)
        bench.step(1e-3)
    assert (bench.processor.state, bench.processor.fault, bench.excited) == (State.FAULT, fault, None)
    assert bench.references[-1].max() == 0.0
    assert bench.ask(Command.EXCITE, VOLTAGE_OF_Y)[1] == Result.WRONG_STATE
    assert bench.ask(Command.ACKNOWLEDGE)[1] == Result.DONE
    assert bench.ask(Command.EXCITE, VOLTAGE_OF_Y)[1] == Result.DONE


def test_references_of_positions_are_not_played_in_it() -> None:
    bench = Bench(silence=0.02, hold=0.0)
    bench.ask(Command.EXCITE, VOLTAGE_OF_Y)
    bench.stream(199)
    assert not np.any(bench.references)
    assert bench.processor.state is State.EXCITED
    bench.stream(10)
    assert bench.processor.fault is Fault.REFERENCE_SILENT


@pytest.mark.parametrize("argument", [0, 1, 256 * 3, 256 * Drive.EXTENSION + 3])
def test_what_cannot_be_excited_is_refused(argument: int) -> None:
    bench = Bench()
    assert bench.ask(Command.EXCITE, argument)[1] == Result.REFUSED
    assert (bench.processor.state, bench.excited) == (State.HOLDING, None)


def test_a_classic_bus_is_too_slow_for_it() -> None:
    assert Bench(form="classic").ask(Command.EXCITE, VOLTAGE_OF_Y)[1] == Result.REFUSED


def test_a_stage_that_follows_is_not_excited() -> None:
    bench = Bench()
    bench.ask(Command.START)
    assert bench.ask(Command.EXCITE, VOLTAGE_OF_Y)[1] == Result.WRONG_STATE

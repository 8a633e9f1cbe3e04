"""The stage's processor, on a time and a wire that the tests make themselves."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from firmware_sim.slcan_adapter import Frame
from firmware_sim.stage_processor import Loops
from stagectl.wire import messages, samples
from stagectl.wire.messages import Command, Fault, HostState, Result, State
from stagectl.wire.parameters import checksum, chunks, pack_parameters
from tests.firmware_sim.processor_bench import Bench


def following(**settings: Any) -> Bench:
    bench = Bench(**settings)
    assert bench.ask(Command.START)[1] == Result.DONE
    bench.stream(10)
    assert bench.processor.state is State.FOLLOWING
    return bench


def test_switched_on_it_holds_at_mid_travel_and_says_so() -> None:
    bench = Bench()
    bench.step(0.0005)
    for _ in range(100):
        bench.step(1e-3)
    assert bench.heartbeat() == (State.HOLDING, Fault.NONE)
    assert not np.any(bench.references)
    assert len(bench.said(messages.POSITION)) == 101
    assert bench.said(messages.STATUS)[-1][:2] == (100_500_000, 101)


def test_references_before_start_are_not_followed() -> None:
    bench = Bench()
    bench.stream(10)
    assert not np.any(bench.references)


def test_started_it_follows_the_references_two_blocks_behind() -> None:
    bench = Bench(ahead=2)
    bench.ask(Command.START)
    for n in range(1, 6):
        bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
        bench.refer(1e-5 * n)
        bench.step(1e-3)
    assert [round(1e5 * block[0, 0]) for block in bench.references[-5:]] == [0, 1, 2, 3, 4]
    newest = next(frame for frame in reversed(bench.frames) if frame.identifier == messages.POSITION.identifier)
    np.testing.assert_allclose(samples.decode(messages.POSITION, newest.data)[1], 4e-5)


def test_the_block_counter_counts_milliseconds() -> None:
    bench = Bench()
    bench.step(0.0505)
    counters = [messages.POSITION.unpack(frame.data)[0] for frame in bench.frames if frame.identifier == 0x101]
    assert counters == list(range(51))


def test_stop_brings_it_to_mid_travel_and_to_hold() -> None:
    bench = following(ramp=0.01)
    assert bench.ask(Command.STOP)[1] == Result.DONE
    assert bench.processor.state is State.RAMPING
    assert bench.ask(Command.START)[1] == Result.WRONG_STATE
    bench.step(0.02)
    assert (bench.processor.state, bench.processor.fault) == (State.HOLDING, Fault.NONE)
    assert not bench.references[-1].any()
    steps = np.abs(np.diff(np.vstack(bench.references)[:, 0]))
    assert steps[-150:].max() < 1e-5 * np.pi / 2 / 100 * 1.01


def garble(bench: Bench) -> None:
    for _ in range(55):
        bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
        bench.processor.receive(Frame(messages.REFERENCE.identifier, bytes(64), True), bench.now)
        bench.step(1e-3)


def beat_only(bench: Bench) -> None:
    for _ in range(55):
        bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
        bench.step(1e-3)


def refer_only(bench: Bench) -> None:
    for _ in range(30):
        bench.refer(1e-5)
        bench.step(1e-3)


def latch_the_loops(bench: Bench) -> None:
    bench.fault = Fault.SENSOR_STUCK
    bench.stream(2)


def lose_many(bench: Bench) -> None:
    bench.refer(1e-5, skip=55)
    bench.step(1e-3)


def suspend(bench: Bench) -> None:
    bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
    bench.now += 1.0
    bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
    bench.refer(1e-5)
    bench.step(0.0)


@pytest.mark.parametrize(
    ("go_wrong", "fault"),
    [
        (lambda bench: bench.step(0.021), Fault.HOST_SILENT),
        (refer_only, Fault.HOST_SILENT),
        (beat_only, Fault.REFERENCE_SILENT),
        (lose_many, Fault.REFERENCE_SILENT),
        (garble, Fault.REFERENCE_GARBLED),
        (lambda bench: bench.stream(1, state=HostState.FAULT), Fault.HOST_FAULT),
        (latch_the_loops, Fault.SENSOR_STUCK),
        (suspend, Fault.OVERRUN),
    ],
)
def test_what_goes_wrong_ends_at_mid_travel_until_a_person_acknowledges(
    go_wrong: Callable[[Bench], None], fault: Fault
) -> None:
    bench = following()
    go_wrong(bench)
    assert (bench.processor.state, bench.processor.fault) == (State.RAMPING, fault)
    assert bench.ask(Command.ACKNOWLEDGE)[1] == Result.WRONG_STATE
    bench.stream(120)
    assert bench.heartbeat() == (State.FAULT, fault)
    assert not bench.references[-1].any()
    assert bench.ask(Command.START)[1] == Result.WRONG_STATE
    assert bench.ask(Command.ACKNOWLEDGE)[1] == Result.DONE
    assert bench.cleared == 1
    bench.step(0.01)
    assert bench.heartbeat() == (State.HOLDING, Fault.NONE)
    assert bench.ask(Command.START)[1] == Result.DONE


def test_19_ms_without_the_host_are_borne() -> None:
    bench = following()
    bench.step(0.0185)
    assert bench.processor.state is State.FOLLOWING


def test_the_host_need_not_be_there_while_it_holds() -> None:
    bench = Bench()
    bench.step(0.4)
    assert (bench.processor.state, bench.processor.fault) == (State.HOLDING, Fault.NONE)


def test_loops_that_fail_are_a_fault() -> None:
    bench = following()
    bench.processor._loops = Loops(np.linalg.cholesky)  # type: ignore[arg-type]  # noqa: SLF001 (they break in mid-run)
    bench.stream(1)
    assert bench.processor.fault is Fault.CONTROLLER


def test_a_position_out_of_range_is_a_fault() -> None:
    bench = following()
    bench.processor._loops = Loops(lambda reference: {"position": reference + 1.0})  # noqa: SLF001
    bench.stream(1)
    assert bench.processor.fault is Fault.CONTROLLER


def test_the_first_fault_is_kept() -> None:
    bench = following()
    bench.step(0.021)
    latch_the_loops(bench)
    assert bench.processor.fault is Fault.HOST_SILENT


def test_a_few_lost_references_are_filled_and_counted() -> None:
    bench = following()
    bench.refer(2e-5, skip=3)
    bench.stream(10, 2e-5)
    assert bench.processor.state is State.FOLLOWING
    bench.step(0.0)
    bench.now += 0.1
    bench.say(messages.HOST_HEARTBEAT, HostState.STREAMING, 0, 0)
    bench.refer(2e-5)
    bench.step(0.0)
    assert bench.said(messages.STATUS)[-1][3] == 3


def test_a_command_asked_twice_is_carried_out_once() -> None:
    bench = Bench()
    first = bench.ask(Command.START, token=7)
    bench.stream(3)
    assert bench.ask(Command.START, token=7) == first == (7, Result.DONE, 0)
    assert bench.ask(Command.START, token=8)[1] == Result.WRONG_STATE


def test_a_command_that_comes_again_while_its_host_may_be_silent_is_the_same_one() -> None:
    """A machine that stands still for seconds has sent the command twice before it reads the answer."""
    bench = Bench(silence=10.0)
    first = bench.ask(Command.START, token=7)
    for _ in range(2):
        bench.now += 8.0
        assert bench.ask(Command.START, token=7) == first
    bench.now += 11.0
    assert bench.ask(Command.START, token=7) != first


def test_the_same_command_a_second_later_is_another_one() -> None:
    bench = following(ramp=0.01)
    assert bench.ask(Command.START, token=7)[1] == Result.WRONG_STATE
    bench.ask(Command.STOP, token=8)
    assert bench.ask(Command.START, token=7)[1] == Result.WRONG_STATE
    for _ in range(1100):
        bench.step(1e-3)
    assert bench.ask(Command.START, token=7)[1] == Result.DONE


@pytest.mark.parametrize("form", ["fd", "classic"])
def test_parameters_are_uploaded_read_back_and_committed(form: str) -> None:
    bench = Bench(form=form)
    write, read = messages.WRITE_CHUNK, messages.READ_CHUNK
    if form == "classic":
        write, read = messages.SLOW_WRITE_CHUNK, messages.SLOW_READ_CHUNK
    image = pack_parameters({"gains": np.arange(5.0)})
    pieces = chunks(image, len(write.fields) - 1)
    assert bench.ask(Command.BEGIN, len(image))[1] == Result.DONE
    for number, data in enumerate(pieces):
        bench.say(write, number, *data)
    assert bench.ask(Command.CHECK)[1:] == (Result.DONE, len(pieces))
    assert bench.ask(Command.READ, 0)[1] == Result.DONE
    assert [bytes(data) for _, *data in bench.said(read)] == pieces[:16]
    assert bench.ask(Command.COMMIT, checksum(image))[1] == Result.DONE
    assert list(bench.committed) == ["gains"]  # type: ignore[call-overload]


def test_on_classic_can_it_speaks_short_frames_only_and_goes_straight_from_sample_to_sample() -> None:
    bench = Bench(form="classic", ahead=1)
    bench.ask(Command.START)
    data = samples.encode(messages.SLOW_REFERENCE, 0, np.full((1, 3), 1e-4))
    bench.processor.receive(Frame(messages.SLOW_REFERENCE.identifier, data, False), bench.now)
    bench.step(1e-3)
    np.testing.assert_allclose(bench.references[-1][:, 1], 1e-5 * np.arange(1, 11))
    assert {len(frame.data) for frame in bench.frames} == {8}
    newest = next(frame for frame in reversed(bench.frames) if frame.identifier == 0x121)
    np.testing.assert_allclose(samples.decode(messages.SLOW_POSITION, newest.data)[1], 1e-4)


def test_at_the_hosts_pace_there_is_a_block_for_each_reference() -> None:
    bench = Bench(pace="host")
    bench.ask(Command.START)
    before = bench.processor.block
    for n in range(500):
        bench.refer(1e-7 * n)
        bench.step(0.0)
    assert bench.processor.block == before + 500
    np.testing.assert_allclose(bench.references[-1], 1e-7 * 499, atol=1e-8)
    bench.step(0.021)
    assert bench.processor.fault is Fault.HOST_SILENT
    bench.step(0.2)
    assert bench.processor.state is State.FAULT


def test_frames_of_others_are_passed_over() -> None:
    bench = Bench()
    bench.processor.receive(Frame(0x7FF, b"", False), bench.now)
    bench.processor.receive(Frame(messages.POSITION.identifier, bytes(64), True), bench.now)
    assert bench.processor.garbled == 0

"""The clocks, on a time that the tests make themselves."""

import threading

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port
from ctlblocks.clock import Timer, run_offline
from tests.until import EVER


class Time:
    """A monotonic clock that only moves when someone sleeps or works."""

    def __init__(self) -> None:
        self.now = 1e6
        self.slept: list[float] = []

    def __call__(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        assert seconds > 0
        self.slept.append(seconds)
        self.now += seconds


class Work(Block):
    """Emit ones; take, at each call, as long as `durations` says, and call `at`."""

    outputs = (Port("drive", "V", 2), Port("other"))

    def __init__(self, time: Time, durations: dict[int, float], fail_at: int = -1) -> None:
        self.time, self.durations, self.fail_at = time, durations, fail_at
        self.began: list[float] = []

    def process(self, drive: np.ndarray, other: np.ndarray) -> None:
        self.began.append(self.time.now)
        drive.fill(1.0)
        other.fill(1.0)
        if len(self.began) - 1 == self.fail_at:
            raise OSError("bus is gone")
        self.time.now += self.durations.get(len(self.began) - 1, 0.0)


def timed(durations: dict[int, float] | None = None, fail_at: int = -1) -> tuple[Timer, Work, Graph, Time]:
    time = Time()
    work, graph = Work(time, durations or {}, fail_at), Graph(1000.0, 10)  # 10 ms a tick
    graph.add("work", work)
    graph.prepare()
    return Timer(graph, ["work.drive"], now=time, sleep=time.sleep), work, graph, time


def begun(work: Work) -> list[float]:
    return [round((began - 1e6) * 1e3, 3) for began in work.began]


def test_offline_ticks_as_often_as_asked_and_says_so() -> None:
    _, work, graph, time = timed()
    assert run_offline(graph, 5) == 5
    assert (len(work.began), graph.ticks, time.slept) == (5, 5, [])


def test_offline_raises_what_a_block_raises() -> None:
    _, work, graph, _ = timed(fail_at=2)
    with pytest.raises(OSError, match="bus is gone"):
        run_offline(graph, 5)
    assert len(work.began) == 3


def test_offline_refuses_fewer_than_no_ticks() -> None:
    with pytest.raises(ValueError, match="ticks is -1, must be >= 0"):
        run_offline(timed()[2], -1)


def test_offline_stops_from_another_thread_after_a_whole_tick() -> None:
    graph, stop, running = Graph(1.0), threading.Event(), threading.Event()

    class Tell(Block):
        outputs = (Port("nothing"),)

        def process(self, nothing: np.ndarray) -> None:
            running.set()

    graph.add("tell", Tell())
    graph.prepare()
    done: list[int] = []
    thread = threading.Thread(target=lambda: done.append(run_offline(graph, 10**9, stop)), daemon=True)
    thread.start()
    assert running.wait(EVER)
    stop.set()
    thread.join(5)
    assert not thread.is_alive()
    assert done == [graph.ticks]


def test_a_timer_ticks_on_time_and_drifts_not() -> None:
    timer, work, _, _ = timed(dict.fromkeys(range(1000), 0.003))
    timer.run(1000)
    assert begun(work) == [10.0 * n for n in range(1000)]
    assert (timer.late, timer.fault) == (0, None)
    assert timer.worst == pytest.approx(0.0, abs=1e-9)


def test_a_late_tick_is_counted_and_the_timer_catches_up_without_skipping() -> None:
    timer, work, graph, _ = timed({2: 0.034})
    timer.run(8)
    assert begun(work) == [0, 10, 20, 54, 54, 54, 60, 70]
    assert timer.late == 2  # 24 and 14 ms; the third is 4 ms behind, within its own tick
    assert timer.worst == pytest.approx(0.024)
    assert graph.ticks == 8


def test_a_clock_that_wakes_late_counts_as_late() -> None:
    timer, _, _, time = timed()
    timer.run(1)
    assert timer.late == 0
    timer, _, _, time = timed()
    sleep = time.sleep
    timer = Timer(timed()[2], [], now=time, sleep=lambda seconds: sleep(seconds + 0.0101))
    timer.run(2)
    assert timer.late == 1
    assert timer.worst == pytest.approx(0.0101)


def test_a_backlog_beyond_patience_is_a_fault_and_is_not_played() -> None:
    timer, work, graph, _ = timed({1: 1.5})
    with pytest.raises(TimeoutError, match=r"tick 2 is 1.49 s late, must be <= 1 s"):
        timer.run(100)
    assert len(work.began) == 2
    assert isinstance(timer.fault, TimeoutError)
    assert not graph.signal("work.drive").any()


def test_a_fault_zeroes_the_named_outputs_is_kept_and_is_raised() -> None:
    timer, work, graph, _ = timed(fail_at=3)
    with pytest.raises(OSError, match="bus is gone"):
        timer.run(10)
    assert len(work.began) == 4
    assert isinstance(timer.fault, OSError)
    assert not graph.signal("work.drive").any()
    assert graph.signal("work.other").all()  # not named


def test_the_named_outputs_are_zero_after_a_run_that_ends_well() -> None:
    timer, _, graph, _ = timed()
    timer.run(2)
    assert not graph.signal("work.drive").any()


def test_a_timer_runs_once() -> None:
    timer, work, _, _ = timed()
    timer.run(2)
    timer.run(2)
    assert len(work.began) == 2


def test_a_timer_stopped_before_it_starts_does_not_start() -> None:
    timer, work, _, _ = timed()
    timer.stop()
    timer.run()
    assert work.began == []


def test_a_timer_stops_from_another_thread_and_zeroes() -> None:
    timer, work, graph, time = timed()
    slept = threading.Event()
    real_sleep = time.sleep

    def sleep(seconds: float) -> None:
        slept.set()
        real_sleep(seconds)

    timer = Timer(graph, ["work.drive"], now=time, sleep=sleep)
    thread = threading.Thread(target=timer.run, daemon=True)
    thread.start()
    assert slept.wait(EVER)
    timer.stop()
    thread.join(5)
    assert not thread.is_alive()
    assert timer.fault is None
    assert graph.ticks == len(work.began) > 0
    assert not graph.signal("work.drive").any()


def test_an_output_to_zero_that_is_not_there_is_refused_before_the_run() -> None:
    with pytest.raises(KeyError, match="no port 'force'"):
        Timer(timed()[2], ["work.force"])


def test_the_real_clock_keeps_real_time() -> None:
    _, work, graph, _ = timed()
    timer = Timer(graph, [])
    timer.run(2)
    assert len(work.began) == 2
    assert timer.worst >= 0.0

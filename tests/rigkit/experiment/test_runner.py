"""The runner of experiments: phases in order, recorded as they go, ended by a stop or a fault that is told."""

import errno
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port, recording
from ctlblocks.clock import run_offline
from ctlblocks.room import DiskFault
from ctlblocks.taps import Tap
from rigkit.experiment.kept import records_of
from rigkit.experiment.part import Part, Phase, Retreat, Track, nothing
from rigkit.experiment.runner import STOPPED, Conduct, Ended, remembered, repeated
from rigkit.experiment.succession import perform
from rigkit.growing_wav import GrowingWav
from rigkit.run_folder import RunFolder, read_events
from rigkit.stop import Stopped

RATE = 100.0


class Count(Block):
    """Counts samples, and raises at one of them."""

    outputs = (Port("number", "m", 2),)

    def __init__(self, worst: int = -1) -> None:
        self._worst = worst

    def prepare(self, rate: float, frames: int) -> None:
        self._next = 0

    def process(self, number: np.ndarray) -> None:
        if self._next == self._worst:
            raise ValueError("the belt has slipped")
        number[:] = self._next, -self._next
        self._next += 1


class Own:
    """A clock of a device's own, which is asked before each tick."""

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        for done in range(ticks):
            if over():
                return done
            graph.tick()
        return ticks


def part(name: str = "", worst: int = -1, clock: Own | None = None, **calls: Callable[[], object]) -> Part:
    graph = Graph(RATE)
    graph.add("count", Count(worst))
    stem = f"counts-{name}" if name else "counts"
    tracks = (
        Track(stem, (Tap("number", "count.number"),), frozenset()),
        Track(f"{stem}-late", (Tap("number", "count.number", delayed=True),), frozenset(), every=10),
    )
    phases = Phase("one", 200, end=calls.get("end", nothing)), Phase("two", 100, begin=calls.get("begin", nothing))
    return Part(name, graph, tracks, phases, clock)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[RunFolder]:
    with RunFolder.create(tmp_path / "run", "") as made:
        yield made


def parts(*made: Part) -> Iterator[Part]:
    yield from made


@pytest.mark.parametrize("clock", [None, Own()])
def test_what_is_recorded_is_what_is_remembered_tick_by_tick(folder: RunFolder, clock: Own | None) -> None:
    assert perform(folder, parts(part(clock=clock)), {"who": "a test"}, Conduct()) == {}
    kept, (again, ended) = records_of(folder.path), remembered(part(), Conduct())
    assert ended == Ended()
    assert kept.keys() == again.keys() == {"counts", "counts-late"}
    for name, each in kept.items():
        assert (each.names, each.units, each.rate) == (again[name].names, again[name].units, again[name].rate)
        assert each.data.tobytes() == np.ascontiguousarray(again[name].data).tobytes()
    assert kept["counts"].data[:, 0].tolist() == list(range(300))
    assert kept["counts-late"].rate == RATE / 10
    assert kept["counts-late"].data[:4, 1].tolist() == [0, -9, -19, -29]
    assert kept["counts"].provenance["who"] == "a test"
    started, told = read_events(folder.path)
    assert (started["event"], started["part"]) == ("started", "")
    assert (told["event"], told["seconds"], told["ticks"], told["reason"], told["lost"]) == ("ended", 3.0, 300, "", 0)


def test_phases_begin_and_end_where_they_should(folder: RunFolder) -> None:
    seen = []
    made = part(
        end=lambda: seen.append(("end", made.graph.ticks)), begin=lambda: seen.append(("begin", made.graph.ticks))
    )
    perform(folder, parts(made), {}, Conduct())
    assert seen == [("end", 200), ("begin", 200)]


def test_a_part_that_is_held_is_longer_by_that(folder: RunFolder) -> None:
    seen, held = [], []
    made = part(clock=Own(), end=lambda: seen.append(made.graph.ticks))
    made = replace(made, hold=lambda on: held.extend([True] * on), late=lambda: len(held))
    perform(folder, parts(made), {}, Conduct(held=lambda: 50 <= made.graph.ticks < 80))
    assert (seen, made.graph.ticks) == ([230], 330)


@pytest.mark.parametrize("clock", [None, Own()])
def test_a_stop_ends_the_part_under_way_and_those_to_come(folder: RunFolder, clock: Own | None) -> None:
    first, second = part("a"), part("b", clock=clock)
    conduct = Conduct(lambda: second.graph.ticks >= 150, look=lambda graph: seen.append(graph.ticks))
    seen: list[int] = []
    assert perform(folder, parts(first, second, part("c")), {}, conduct) == {"b": STOPPED}
    assert len(records_of(folder.path)["counts-b"].data) == 150
    assert set(records_of(folder.path)) == {"counts-a", "counts-a-late", "counts-b", "counts-b-late"}
    assert read_events(folder.path)[-1]["reason"] == STOPPED
    assert seen[:3] == ([] if clock is None else [0, 0, 1])


@pytest.mark.parametrize("clock", [None, Own()])
def test_a_fault_is_raised_and_told_and_what_was_recorded_is_kept(folder: RunFolder, clock: Own | None) -> None:
    with pytest.raises(ValueError, match="the belt has slipped"):
        perform(folder, parts(part(worst=123, clock=clock)), {}, Conduct())
    assert len(records_of(folder.path)["counts"].data) == 123
    assert read_events(folder.path)[-1]["reason"] == "the belt has slipped"


def test_a_phase_that_refuses_ends_the_part(folder: RunFolder) -> None:
    def refuse() -> None:
        raise ValueError("not ready")

    with pytest.raises(ValueError, match="not ready"):
        perform(folder, parts(part(end=refuse)), {}, Conduct())
    assert len(records_of(folder.path)["counts"].data) == 200


@pytest.mark.parametrize("worst", [-1, 50])
def test_what_is_led_is_held_before_anything_else_is_done(folder: RunFolder, worst: int) -> None:
    made, seen = part(worst=worst, clock=Own()), []
    led = replace(made, rest=lambda: seen.append((made.graph.ticks, len(read_events(folder.path)))))
    with nullcontext() if worst < 0 else pytest.raises(ValueError, match="slipped"):
        perform(folder, parts(led), {}, Conduct())
    assert seen == [(300 if worst < 0 else 50, 1)]  # "ended" is not told yet


def test_what_is_recorded_is_in_its_file_when_its_end_is_told(folder: RunFolder) -> None:
    rows: list[int] = []

    def listen(event: str, _: object) -> None:
        if event == "ended":
            rows.append(len(recording.read(folder.path / "counts.wav").data))

    folder.listener = listen
    perform(folder, parts(part()), {}, Conduct())
    assert rows == [300]


def test_where_a_retreat_began_is_told_though_it_does_not_end(folder: RunFolder) -> None:
    made = part(worst=140, clock=Own())
    retreat = Retreat(lambda: "", lambda _: None, 100)
    with pytest.raises(ValueError, match="the belt has slipped"):
        perform(folder, parts(replace(made, retreat=retreat)), {}, Conduct(lambda: made.graph.ticks == 120))
    events = read_events(folder.path)
    assert [event["event"] for event in events] == ["started", "held", "ended"]
    assert (events[1]["held_at"], events[1]["seconds"]) == (120, 1.2)
    assert (events[2]["held_at"], events[2]["ticks"]) == (None, 140)


def test_a_simulation_ends_where_the_disk_takes_no_more(folder: RunFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "no space left")

    monkeypatch.setattr(GrowingWav, "append", full)
    with pytest.raises(DiskFault, match="no space left"):
        perform(folder, parts(part()), {}, Conduct())
    (ended,) = (event for event in read_events(folder.path) if event["event"] == "ended")
    assert "no space left" in ended["reason"]


def test_it_may_be_held_or_ended_between_parts(folder: RunFolder) -> None:
    asked, shown = [], []

    def between(name: str) -> None:
        asked.append(name)
        if name == "b":
            raise Stopped("ended, as asked")

    with pytest.raises(Stopped):
        perform(folder, parts(part("a"), part("b")), {}, Conduct(between=between, show=shown.append))
    assert asked == ["a", "b"]
    assert set(records_of(folder.path)) == {"counts-a", "counts-a-late"}
    assert shown == sorted(shown)
    assert shown[-1] == 3.0


@pytest.mark.parametrize(("goes_on", "begun"), [(True, ["a", "b"]), (False, ["a"])])
def test_a_part_apart_is_run_after_a_fault_of_another_where_that_is_wanted(
    folder: RunFolder, goes_on: bool, begun: list[str]
) -> None:
    first = replace(braked(110), name="a", is_apart=True)
    asked: list[str] = []
    perform(folder, parts(first, part("b")), {}, Conduct(between=asked.append, goes_on=goes_on))
    assert asked == begun


def test_devices_are_closed_whatever_ends_it(folder: RunFolder) -> None:
    closed = []

    def opened() -> Iterator[Part]:
        try:
            yield part(worst=1)
        finally:
            closed.append(True)

    with pytest.raises(ValueError, match="slipped"):
        perform(folder, opened(), {}, Conduct())
    assert closed == [True]


def test_while_it_runs_it_is_on_the_disk(folder: RunFolder) -> None:
    def looked() -> bool:
        growing = list(folder.path.glob("counts.part.wav"))
        lengths.append(recording.read(growing[0]).data.shape[0] if growing and growing[0].stat().st_size > 900 else 0)
        return False

    lengths: list[int] = []
    perform(folder, parts(part(clock=Slow())), {}, Conduct(looked))
    assert max(lengths) > 100


class Slow:
    """Waits for the recorder's thread, now and then."""

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        from threading import Event

        for _ in range(10):
            run_offline(graph, ticks // 10)
            Event().wait(0.1)
            over()
        return ticks


class Brake(Block):
    """Counts until it is held; then what it gives comes to rest, and why is `reason`."""

    outputs = (Port("number"),)

    def __init__(self, fault_at: int = -1) -> None:
        self._fault_at = fault_at

    def prepare(self, rate: float, frames: int) -> None:
        self._number, self._done, self.reason = 0.0, 0, ""

    def process(self, number: np.ndarray) -> None:
        if self._done == self._fault_at:
            self.hold("it smokes")
        self._done += 1
        self._number = 0.9 * self._number if self.reason else self._number + 1.0
        number[:] = self._number

    def hold(self, reason: str) -> None:
        self.reason = self.reason or reason


def braked(fault_at: int = -1, ticks: int = 300) -> Part:
    graph, brake = Graph(RATE), Brake(fault_at)
    graph.add("brake", brake)
    track = Track("brake", (Tap("number", "brake.number"),), frozenset({"number"}))
    retreat = Retreat(lambda: brake.reason, brake.hold, 40)
    return Part("", graph, (track,), (Phase("all", ticks),), retreat=retreat, counts=lambda: {"brakes": 1})


@pytest.mark.parametrize(
    ("fault_at", "stop_at", "reason", "held_at", "rows"),
    [(110, 999, "it smokes", 115, 155), (-1, 200, STOPPED, 200, 240), (290, 999, "it smokes", 295, 300),
     (299, 999, "it smokes", 300, 300), (-1, 999, "", None, 300)],
)  # fmt: skip
def test_a_part_comes_to_rest_and_what_it_does_is_repeated(
    folder: RunFolder, fault_at: int, stop_at: int, reason: str, held_at: int | None, rows: int
) -> None:
    made = braked(fault_at)
    assert perform(folder, parts(made), {}, Conduct(lambda: made.graph.ticks >= stop_at)) == (
        {"": reason} if reason else {}
    )
    kept, told = records_of(folder.path)["brake"], read_events(folder.path)[-1]
    assert (told["ticks"], told["held_at"], told["reason"], told["brakes"]) == (rows, held_at, reason, 1)
    assert len(kept.data) == rows
    again = repeated(braked(fault_at), rows, held_at)["brake"]
    assert again.data.tobytes() == np.ascontiguousarray(kept.data).tobytes()

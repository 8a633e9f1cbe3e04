"""A flood of STOPs: each is obeyed, and the event log stays what it is for."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from rigkit import line_file
from rigkit.service import journal
from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.stop_log import ASKERS
from tests.rigkit.service.demo_rig import DemoRig

MINUTE = 60
KEPT = 50


class Bench:
    """A control whose time is told."""

    def __init__(self, path: Path) -> None:
        self.at, self.path, self.rig = 0.0, path, DemoRig()
        self.control = Control(self.rig, Lease(1e6), Journal(path), lambda: self.at)
        self.key = self.control.take_control("Ada", False)["key"]

    def stop(self, asker: str = "view at 10.0.0.7", who: str = "Eve") -> None:
        assert self.control.stop(who, "smoke", asker)["state"] == "DISARMED"

    def flood(self, seconds: float, rate: int = 20) -> None:
        """Let STOPs come, and the daemon's look 25 times a second."""
        for _ in range(round(seconds * rate)):
            self.stop()
            self.at += 1 / rate
            self.control.settle()

    def told(self) -> list[dict[str, Any]]:
        return [entry for entry in self.control.journal.since(0) if entry["event"] == "stop"]

    def written(self) -> list[dict[str, Any]]:
        self.control.journal.close(60)
        return [json.loads(line) for line in line_file.lines(self.path) if '"stop"' in line]


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path / "events.jsonl")
    yield made
    made.control.journal.close(60)


def test_each_stop_of_a_flood_is_obeyed_and_the_first_is_told_at_once(bench: Bench) -> None:
    bench.control.arm(bench.key, "a test")
    bench.stop()
    assert [(entry["before"], "times" in entry) for entry in bench.told()] == [("ARMED", False)]
    before = bench.rig.stops
    bench.flood(10.0)
    assert bench.rig.stops >= before + 200


def test_repeats_are_told_at_most_once_a_second_and_none_is_lost(bench: Bench) -> None:
    bench.flood(0.9)
    assert len(bench.told()) == 1
    bench.flood(20 * MINUTE)
    bench.control.arm(bench.key, "it is over")
    entries = bench.written()
    assert entries[-1]["times"] == 20 * 20 * MINUTE + 18
    assert entries[-1]["asker"] == "view at 10.0.0.7"
    assert len(entries) < 20 + 10
    counts = [entry["times"] for entry in entries[1:]]
    assert counts == sorted(counts)
    assert min(b - a for a, b in zip(counts[:-2], counts[1:-1], strict=True)) >= 20


def test_a_flood_pushes_no_other_event_out_of_memory(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journal, "KEPT", KEPT)
    for number in range(KEPT - 10):
        bench.control.journal.add("note", "run", {"n": number})
    bench.flood(60 * MINUTE, rate=2)
    kept = bench.control.journal.since(0)
    assert [entry["n"] for entry in kept if entry["event"] == "note"] == list(range(KEPT - 10))
    assert kept[0]["event"] == "control"
    assert len(bench.told()) == 2
    assert bench.told()[-1]["number"] == bench.control.journal.number
    assert bench.control.journal.since(kept[-2]["number"]) == [kept[-1]]


def test_repeats_that_wait_are_told_before_what_comes_after_them(bench: Bench) -> None:
    bench.stop()
    bench.stop()
    bench.control.arm(bench.key, "it is over")
    bench.stop()
    bench.stop()
    bench.control.close(10.0)
    kept = [(entry["event"], entry.get("times", 1)) for entry in bench.control.journal.since(1)]
    assert kept == [("stop", 1), ("stop", 2), ("arm", 1), ("stop", 1), ("stop", 1), ("stop", 2)]


def test_askers_are_told_apart_by_address_and_not_by_the_name_they_give(bench: Bench) -> None:
    for number in range(50):
        bench.stop("view at 10.0.0.7", f"Eve {number}")
    bench.stop("operate at 10.0.0.8", "Ada")
    assert [entry["who"] for entry in bench.told()] == ["Eve 0", "Ada"]


def test_more_askers_than_can_be_told_apart_count_as_one(bench: Bench) -> None:
    for number in range(1000):
        bench.stop(f"view at 10.0.{number // 256}.{number % 256}")
    assert len(bench.told()) == ASKERS + 1
    bench.at += 1.0
    bench.control.settle()
    assert bench.told()[-1]["times"] == 1000 - ASKERS

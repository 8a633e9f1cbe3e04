"""What is shown of a rig."""

import json

from rigkit.service.snapshot import as_bytes, snapshot
from rigkit.service.state import State
from tests.rigkit.service.conftest import Bench
from tests.until import until


def test_a_snapshot_begins_with_its_tick_and_tells_state_and_owner(bench: Bench) -> None:
    bench.arm()
    content = as_bytes(snapshot(bench.control, 7, 1, 0.0))
    assert content.startswith(b'{"tick": 7, ')
    shown = json.loads(content)
    assert (shown["state"]["name"], shown["state"]["who"], shown["state"]["why"]) == ("ARMED", "Ada", "to see it")
    assert shown["control"]["who"] == "Ada"
    assert shown["allowed"] == ["disarm", "calibrate", "run", "stop"]
    assert [gauge["verdict"] for gauge in shown["gauges"]] == ["good", shown["gauges"][1]["verdict"], "free", "unknown"]


def test_a_rig_that_cannot_say_how_it_is_is_in_fault_and_the_daemon_goes_on(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=100_000, seconds=10.0)
    until(lambda: bench.rig.output)

    def broken() -> None:
        raise OSError(5, "Input/output error", "/data")

    bench.rig.gauges = broken  # type: ignore[method-assign,assignment]
    for tick in range(3):
        shown = snapshot(bench.control, tick, 0, 0.0)
    assert shown["gauges"] == []
    assert bench.rig.output == 0.0
    assert bench.state is State.FAULT
    assert bench.control.machine.last.why == "the gauges cannot be read: /data: Input/output error"
    assert bench.events().count("fault") == 1

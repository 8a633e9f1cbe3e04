"""What Prometheus is told of a procedure."""

import math

import pytest
from prometheus_client.parser import text_string_to_metric_families

from rigkit.service.metrics import Metrics
from rigkit.service.show import Gauge
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes, snapshot
from tests.rigkit.service.conftest import Bench
from tests.until import until

ON = "vibrostage_output_on"
LEFT = "vibrostage_procedure_seconds_left"


def told(bench: Bench) -> dict[str, float]:
    slot = Slot()
    slot.put(as_bytes(snapshot(bench.control, 1, 0, 0.0)))
    families = text_string_to_metric_families(Metrics(slot, lambda: ()).text().decode())
    return {sample.name: sample.value for family in families for sample in family.samples}


def test_the_time_left_is_not_a_number_until_it_is_known_and_gone_with_the_procedure(bench: Bench) -> None:
    bench.arm()
    bench.begin(steps=1_000, seconds=0.02)
    until(lambda: math.isfinite(told(bench)[LEFT]))
    assert 0.0 < told(bench)[LEFT] < 100.0
    bench.control.stop("Ada", "")
    bench.ended()
    assert LEFT not in told(bench)
    bench.arm()
    bench.begin(steps=10, seconds=10.0)
    assert math.isnan(told(bench)[LEFT])


@pytest.mark.parametrize(
    ("value", "on", "word"),
    [(1.0, 1.0, "on"), (-1e-9, 1.0, "on"), (math.inf, 1.0, "on"), (0.0, 0.0, "zero")]
    + [(none, math.nan, "unknown") for none in (None, math.nan)],
)
def test_whether_the_output_is_on_is_not_a_number_where_it_is_not_measured(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, value: float | None, on: float, word: str
) -> None:
    monkeypatch.setattr(bench.rig, "gauges", lambda: [Gauge("output", "Output", value, "V", is_output=True)])
    assert snapshot(bench.control, 1, 0, 0.0)["output"] == word
    assert told(bench)[ON] == pytest.approx(on, nan_ok=True)


def test_a_rig_without_a_gauge_of_its_output_does_not_count_as_zero(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench.rig, "gauges", lambda: [Gauge("travel", "Travel", 0.0, "m")])
    assert snapshot(bench.control, 1, 0, 0.0)["output"] == "unknown"
    assert math.isnan(told(bench)[ON])
    several = [Gauge(f"side_{n}", "Side", value, "V", is_output=True) for n, value in enumerate((0.0, None))]
    monkeypatch.setattr(bench.rig, "gauges", lambda: several)
    assert math.isnan(told(bench)[ON])
    several[0] = Gauge("side_0", "Side", 2.0, "V", is_output=True)
    assert told(bench)[ON] == 1.0

"""What Prometheus is told of a procedure."""

import math

from prometheus_client.parser import text_string_to_metric_families

from rigkit.service.metrics import Metrics
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes, snapshot
from tests.rigkit.service.conftest import Bench
from tests.until import until

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

"""The snapshot for Prometheus: state, gauges and counters in its text format."""

import json
import math
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from typing import Any

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from prometheus_client.registry import Collector

from rigkit.service.show import Output
from rigkit.service.slot import Slot
from rigkit.service.state import State

PREFIX = "vibrostage"
_UNITS = {"V": "volts", "m": "metres", "s": "seconds", "dB": "decibels", "m/s^2": "metres_per_second_squared"}
_UNITS |= {"Pa": "pascals", "N": "newtons", "N m": "newton_metres", "Hz": "hertz", "1": "", "samples": "samples"}
_UNITS |= {"byte": "bytes", "rad": "radians", "m/s": "metres_per_second", "K": "kelvins"}
_ON: dict[Output, float] = {"on": 1.0, "zero": 0.0, "unknown": math.nan}


class Metrics(Collector):
    """Reads the newest snapshot when it is asked.

    Parameters
    ----------
    slot : Slot
    counts : callable() -> iterable of (name, meaning, value)
        What the web process itself counts.
    """

    media_type = CONTENT_TYPE_PLAIN_0_0_4

    def __init__(self, slot: Slot, counts: Callable[[], Iterable[tuple[str, str, float]]]) -> None:
        self._slot, self._counts = slot, counts
        self._registry = CollectorRegistry(auto_describe=False)
        self._registry.register(self)

    def text(self) -> bytes:
        """Return the text that Prometheus fetches."""
        return generate_latest(self._registry)

    def collect(self) -> Iterator[Metric]:
        """Give each metric."""
        for name, meaning, value in self._counts():
            yield CounterMetricFamily(f"{PREFIX}_{name}", meaning, value)
        content = self._slot.get()
        if content is None:
            return
        shown = json.loads(content)
        state = GaugeMetricFamily(
            f"{PREFIX}_state", "1 for the state the rig is in", labels=["program", "rig", "state"]
        )
        for each in State:
            state.add_metric([shown["program"], shown["rig"], each.value], float(each.value == shown["state"]["name"]))
        yield state
        yield CounterMetricFamily(f"{PREFIX}_ticks", "snapshots of the rig's process", shown["tick"])
        yield CounterMetricFamily(f"{PREFIX}_late_ticks", "of those, late ones", shown["late_ticks"])
        yield CounterMetricFamily(f"{PREFIX}_events", "events in the log", shown["events"])
        for name, meaning, value in _standing(shown):
            yield GaugeMetricFamily(f"{PREFIX}_{name}", meaning, value)
        over = GaugeMetricFamily(
            f"{PREFIX}_over_limit", "1 for a gauge beyond one of its limits", labels=["gauge", "title"]
        )
        for gauge in shown["gauges"]:
            yield from _gauge(gauge)
            if gauge["verdict"] in ("good", "near", "over"):
                over.add_metric([gauge["name"], gauge["title"]], float(gauge["verdict"] == "over"))
        yield over


def _standing(shown: dict[str, Any]) -> Iterator[tuple[str, str, float]]:
    """Give name, meaning and value of what holds for every rig."""
    made = datetime.fromisoformat(shown["time"]).timestamp()
    yield "snapshot_timestamp_seconds", "when the rig's process gave its last sign of life, Unix time", made
    yield "recording", "1 while recording", float(shown["recording"])
    yield "output_on", "1 while the rig puts something out; NaN where that is not measured", _ON[shown["output"]]
    yield "control_held", "1 while somebody has control", float(shown["control"] is not None)
    yield "faults_on_purpose", "sensors with a fault that was put in on purpose", float(len(shown["faults"]))
    yield "journal_fault", "1 while events do not get to the disk", float(shown["journal_fault"] != "")
    procedure = shown["procedure"]
    if procedure is not None:
        yield (
            "procedure_done_ratio",
            "part of the procedure that is done",
            procedure["done"] / (procedure["total"] or 1.0),
        )
        left = math.nan if procedure["seconds_left"] is None else procedure["seconds_left"]
        yield "procedure_seconds_left", "how long the procedure will take, about; NaN before it is known", left


def _gauge(gauge: dict[str, object]) -> Iterator[Metric]:
    unit = str(gauge["unit"])
    suffix = _UNITS.get(unit, "")
    name = "_".join(filter(None, (PREFIX, str(gauge["name"]), suffix)))
    parts = ("value", "", ""), ("low", "_low_limit", ", lower limit"), ("high", "_high_limit", ", upper limit")
    for part, ending, meaning in parts:
        value = gauge[part]
        if isinstance(value, int | float):
            yield GaugeMetricFamily(f"{name}{ending}", f"{gauge['title']}{meaning}, {unit}", float(value))

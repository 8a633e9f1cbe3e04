"""What is shown of milling by force: forces, kappa and beta with their uncertainty, the feed, and finished pockets."""

from collections.abc import Iterator

import numpy as np

from rigkit.experiment.strips import TIME, strip, thinned
from rigkit.experiment.watch import WINDOW, Watch
from rigkit.service.show import Axis, Curves, Gauge, Panel, Table, Trace
from stagectl.experiments.feed.pocketed import Kept
from stagectl.experiments.feed.pockets import summary
from stagectl.experiments.feed.report import HEAD, TYPE_HEAD, pocket_rows, type_rows
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_record import CONTROLLING, IDLE

SURE = 2.0
"""Standard deviations to either side of an estimate."""
BELIEVED = {"kappa": ("Kappa: removal for a force", "m/(N s)"), "beta": ("Beta: force across over along", "1")}


def cutting(watch: Watch, settings: ForceFeed) -> Iterator[Gauge]:
    """Give the force in the plane, the feed, and what is believed of the material, with its interval."""
    seen = {name: watch.newest(name) for name in ("resultant", "valid", "feed", "phase")}
    if any(each is None for each in seen.values()):
        return
    force, valid, feed, phase = (float(each[0]) for each in seen.values() if each is not None)
    yield Gauge("force", "Force on the tool, in the plane", force if valid else None, "N", high=settings.overload)
    yield Gauge("feed", "Feed", feed, "m/s", high=settings.highest)
    for name, (title, unit) in BELIEVED.items():
        value, deviation = watch.newest(name), watch.newest(f"{name}_deviation")
        if value is None or deviation is None or phase != CONTROLLING:
            yield Gauge(name, title, None, unit)
            continue
        believed, reach = float(value[0]), SURE * float(deviation[0])
        yield Gauge(name, title, believed, unit, interval=(believed - reach, believed + reach))


def lately(watch: Watch, wanted: float) -> Iterator[tuple[str, Panel]]:
    """Draw the last seconds, by the panels' names.

    Parameters
    ----------
    watch : Watch
    wanted : float, N
        f_d.
    """
    time, phase = watch.lately("phase")
    if not len(time):
        return
    yield "force", _force(watch, wanted)
    yield "feed", _feed(watch)
    on = phase[:, 0] == CONTROLLING
    for name, (title, unit) in BELIEVED.items():
        if (panel := _believed(watch, name, title, unit, on)) is not None:
            yield name, panel


def tables(pockets: list[Kept]) -> dict[str, Panel]:
    """Return the tables of pockets that have been milled, by the panels' names."""
    rows = summary(pockets)["pockets"]
    return {
        "pockets": Table("Pockets", HEAD, tuple(pocket_rows(rows))),
        "types": Table(f"Types of {rows[-1]['name']}", TYPE_HEAD, tuple(type_rows(rows[-1]))),
    }


def _force(watch: Watch, wanted: float) -> Curves:
    """Draw the force where the sensor's counts: not before it has been set to zero."""
    time, along = watch.lately("along")
    size, valid = watch.lately("resultant")[1], watch.lately("valid")[1]
    count = min(len(time), len(size), len(valid))
    rows = np.where(valid[-count:] > 0.5, np.column_stack([along[-count:], size[-count:]]), np.nan)
    names = "against the feed", "across", "resultant"
    panel = strip(f"Force, last {WINDOW:g} s", Axis("force", "N"), time[-count:], rows, names)
    asked = Trace("set-point", time[[0, -1]], np.full(2, wanted), "reference")
    return Curves(panel.title, panel.x, panel.y, (*panel.traces, asked))


def _feed(watch: Watch) -> Curves:
    """Draw the feed along segments; what the tool does between two of them is none."""
    time, asked = watch.lately("feed")
    seen, phase = watch.lately("velocity")[1], watch.lately("phase")[1]
    count = min(len(time), len(seen), len(phase))
    rows = np.where(phase[-count:] != IDLE, np.column_stack([asked[-count:], seen[-count:]]), np.nan)
    return strip(f"Feed, last {WINDOW:g} s", Axis("speed", "m/s"), time[-count:], rows, ("commanded", "measured"))


def _believed(watch: Watch, name: str, title: str, unit: str, on: np.ndarray) -> Curves | None:
    """Draw an estimate with its uncertainty, where the force is controlled."""
    time, value = watch.lately(name)
    reach = SURE * watch.lately(f"{name}_deviation")[1]
    count = min(len(time), len(reach), len(on))
    if not (count and on[-count:].any()):
        return None
    told = np.where(on[-count:], value[-count:, 0], np.nan)
    shown, line, low, high = thinned(time[-count:], told, told - reach[-count:, 0], told + reach[-count:, 0])
    trace = Trace("estimated, twice its deviation", shown, line, low=low, high=high)
    return Curves(title, TIME, Axis(name, unit), (trace,))

"""docs/peers.md from what was measured in one run."""

from collections.abc import Mapping
from typing import Any

from benchmarks.page_table import table
from benchmarks.peers import features, identification, ilc_laws, midranging, planners

HEAD = """\
# Beside others

This page compares this program with packages that do the same, in one run of `make peers` on one machine, and lists
what other systems offer for the same job. Losses are listed first.

Times are of one process on one thread. The machine was not idle, so compare columns of one run, not runs of different
days.

Measured {time} on {machine};
{software}.

## Where ours loses

{losses}
"""
LOSSES = """\
- **Speed of identification**: a subspace model takes 12 to 55 times the processor time of SLICOT's N4SID where that
  terminates, and 0.55 to 6.6 times that of SLICOT's MOESP. The ratio falls with the number of channels and samples.
- **Dynamic programming** is no faster than Dijkstra's algorithm in scipy on the small graphs. It needs no graph; the
  time for building one is not counted for the others.
- **Simulation**: `forced_response` of python-control simulates a linear loop several times as fast as our graph of
  blocks, which checks, limits and records every sample. The results agree.
- **Planners that learn** are not always optimal even where their rates are right; `exact` is.
- **Features**: no random, sine or shock test by standards, no waveform of unlimited length in one pass, no constraint
  in the law, no nonlinear model. None of this program has run on a real machine, while the systems for shakers and
  robots below have."""
IDENTIFICATION = """\
## Identification

The table is an extract of [all results](identification-peers.md), from the run of {made}

"Short" is the number of points of NRMSE by which the true system fits a fresh record better. Order and horizon of ours
are given. In each respect ours is compared with the best of the peers: SLICOT (ctrlsys), SIPPY, nfoursid,
python-control and pysid. Faster models of others are as good in free run. One step ahead ours are as good as the best,
or better, since their gain is fitted.
"""
RESPONSES = "Models of frequency responses beside pyMOR and scikit-rf: [identification](identification.md)."
LAWS = """\
## Learning laws

- **Plants**: 40 drawn plants of 3 to 5 modes with wrong models (frequencies by 2 %, damping ratios by up to 40 %, gains
  by up to 10 %), seeds 9000 to 9039, on which nothing was chosen. They are linear and do not drift; time-domain
  learning on the simulated vibrator is in [how a run learns](learning.md#time-domain-ilc-beside-it).
- **Trials**: 20 trials of 512 samples from rest, noise of 0.2 %. The error is the rms error over the rms of the
  reference.
- **Laws**: gains follow from the model by the textbooks' rules (`benchmarks/peers/ilc_laws.py`). Ours has a prior
  standard deviation of G of 30 %. It starts from the drive G^+ R, the others from zero.
- **Other packages**: no Python package of learning control was found in the package lists.
  IterativeLearningControl2.jl and Simulink's block are in other languages and were not run; their laws are among these.
"""
UPDATES = """\
## One update

One update of a shot of 5 s with two drives and two sensors at 44.1 kHz: transforms, inverse, update, inverse
transforms.
"""
MIDRANGING = """\
## Mid-ranging

`MVPC` is linear while nothing saturates, so python-control can simulate the same loop. `NumpyAxis` is an independent
implementation of the adaptive controller in plain numpy (`benchmarks/midranging_numpy.py`). Both give the same outputs
(`benchmarks/test_midranging_speed.py`).
"""
PLANNING = """\
## Planning

The task is the least time to mill a pocket, with cells of half a tool diameter and random tables of rates
(`benchmarks/planning_pockets.py`). All methods find the same time. The graph for the others is built beforehand, and
this is not counted.
"""
LEARNED = """
The planners that learn, on {tables} random tables each, where all rates are as the planner assumes:
"""
FEATURES = """\
## Features

The tables compare systems that do the same job. Every statement has its source, a page of the maker or of the project
where one was found. For this program the source is its own page. "Not found" means that the stored pages that were
searched do not mention the feature, not that it does not exist.
"""


def page(kept: Mapping[str, Any]) -> str:
    """Return the page that belongs to what was measured.

    Parameters
    ----------
    kept : mapping
        `time`, `machine`, `software`; `laws`, `updates`, `midranging`, `planners`, `learned`: rows.
    """
    parts = [
        HEAD.format(losses=LOSSES, **{name: kept[name] for name in ("time", "machine", "software")}),
        IDENTIFICATION.format(made=identification.made()),
        table(identification.HEAD, identification.rows()),
        f"\n{RESPONSES}\n",
        LAWS,
        table(ilc_laws.HEAD, kept["laws"]),
        f"\n{UPDATES}",
        table(("what", "ms", "over ours"), kept["updates"]),
        f"\n{MIDRANGING}",
        table(midranging.HEAD, kept["midranging"]),
        f"\n{PLANNING}",
        table(planners.HEAD, kept["planners"]),
        LEARNED.format(tables=planners.TABLES),
        table(planners.LEARNED_HEAD, kept["learned"]),
        f"\n{FEATURES}",
        features.sections(),
    ]
    return "\n".join(parts) + "\n"

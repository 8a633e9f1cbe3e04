"""docs/peers.md from what was measured in one run."""

from collections.abc import Mapping
from typing import Any

from benchmarks.page_table import table
from benchmarks.peers import features, identification, ilc_laws, midranging, planners

HEAD = """\
# Beside others

What this program does beside packages that do the same, in one run of `make peers` on one machine, and what other
systems offer for the same job. Losses stand beside wins. Made {time} on {machine}; {software}.
Times are of one process on one thread; the machine was not idle, so compare columns and not days.

## Where ours loses

{losses}
"""
LOSSES = """\
- **Speed of identification**: a subspace model takes 12 to 55 times the processor time of SLICOT's N4SID where that
  ends, and 0.55 to 6.6 times that of its MOESP: the more channels and samples, the less.
- **Dynamic programming** is no faster than Dijkstra's algorithm in scipy on the small graphs; it needs no graph to
  be made, which is not counted against the others.
- **Simulation**: `forced_response` of python-control steps a linear loop several times as fast as our graph of
  blocks, which checks, limits and records every sample. The two agree.
- **Planners that learn** are not always optimal even where their rates are right; `exact` is.
- **Features**: no random, sine or shock test by standards, no waveform of unlimited length in one pass, no
  constraint in the law, no nonlinear model; and nothing of this has run on a real machine, while the
  systems for shakers and robots below have."""
IDENTIFICATION = """\
## Identification

[All of it](identification-peers.md), from the run of {made}
"Short" is by how many points of NRMSE the truth fits a fresh record better. Ours with order and horizon given,
beside the best of the peers in each respect: SLICOT (ctrlsys), SIPPY, nfoursid, python-control and pysid. Quicker
models of others are as good in free run; one step ahead ours are as good as the best or better, since their gain is
fitted.
"""
RESPONSES = "Models of frequency responses beside pyMOR and scikit-rf: [identification](identification.md)."
LAWS = """\
## Learning laws

40 drawn plants of 3 to 5 modes whose models are wrong (frequencies by 2 %, dampings by up to 40 %, gains by up to
10 %), 20 trials of 512 samples from rest, noise of 0.2 %; error over the reference, rms. Seeds 9000 to 9039, on
which nothing was chosen; gains follow from the model as textbooks say (`benchmarks/peers/ilc_laws.py`). Ours is
told that G may be off by
30 % and begins with G^+ R, the others with nothing.
No Python package of learning control was found in the package lists; IterativeLearningControl2.jl and Simulink's
block are of other languages and were not run: their laws are among these. These plants are linear and do not drift;
time-domain learning on the simulated vibrator is in [how a run learns](learning.md#time-domain-ilc-beside-it).
"""
UPDATES = """\
## One update

A shot of 5 s, two drives and two sensors, 44.1 kHz: transforms, inverse, update, back.
"""
MIDRANGING = """\
## Mid-ranging

`MVPC` is linear while nothing saturates, so python-control simulates the same loop. `NumpyAxis` is the adaptive
controller written apart in plain numpy (`benchmarks/midranging_numpy.py`); both give the same outputs
(`benchmarks/test_midranging_speed.py`).
"""
PLANNING = """\
## Planning

The least time to mill a pocket, halves of a tool, random tables (`benchmarks/planning_pockets.py`): all find the
same time. The graph for the others is made beforehand and not counted.
"""
LEARNED = """
The planners that learn, {tables} random tables each where all rates are as believed:
"""
FEATURES = """\
## Features

Of the systems that do the same job. Every statement has its source, a page of the maker or of the project where one
was found; "not found" means that the stored pages which were searched say nothing of it, not that it is not there.
Of ours the source is this program's own page.
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

"""Subspace identification and its refinement on measured records, beside what others reached on them.

`python -m benchmarks.real_identification`, about two minutes.  Free run from the initial state that fits best, and one
step ahead; both on the half not identified from, averaged over outputs.  Of the peers, the best stable one of each
column; of ours every way is shown, and at the end the best of them, chosen by the same figures as the peers' best.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.measured_systems import Case, Pair, cases
from calibration import subspace
from calibration.fit_measures import nrmse, vaf
from calibration.prediction_error import Focus, arx, reduced, refine
from calibration.state_space.model import InnovationModel
from calibration.subspace.realization import Method
from tests.shared_data import DATA

ROUNDING = 0.05
"""Of the peers' figures."""


def fits(model: InnovationModel, record: Pair, by_variance: bool) -> tuple[float, float]:
    """Return free run and one step ahead, %."""
    drive, response = record
    measure = vaf if by_variance else nrmse
    free = model.simulate(drive, model.initial_state(drive, response))
    step = model.predict(drive, response, model.initial_predictor_state(drive, response))
    return float(measure(response, free).mean()), float(measure(response, step).mean())


def ways(case: Case) -> dict[str, Callable[[], InnovationModel]]:
    """Return what can be done with a record, by name; refinements begin at what stands before them."""
    found: dict[str, InnovationModel] = {}

    def start(method: Method) -> InnovationModel:
        found[method] = subspace.identify(*case.own, 1.0, order=case.order, horizon=case.horizon, method=method).model
        return found[method]

    def cut() -> InnovationModel:
        found["arx"] = reduced(arx(*case.own, 1.0, case.horizon, delays=0).model(), case.order)
        return found["arx"]

    def refined(before: str, focus: Focus) -> InnovationModel:
        name = f"{before}, {focus}"
        found[name] = refine(found[before], *case.own, focus=focus).model
        return found[name]

    made = {"n4sid": partial(start, "n4sid"), "moesp": partial(start, "moesp"), "arx": cut}
    for method in tuple(made):
        for before, focus in ((method, "prediction"), (method, "simulation"), (f"{method}, prediction", "simulation")):
            made[f"{before}, {focus}"] = partial(refined, before, focus)
    return made


def main() -> None:
    if not DATA.is_dir():
        print(f"skipped: the data are not at {DATA}")
        return
    for case in cases():
        best = np.full(2, -np.inf)
        print(f"\n{case.name}, s={case.horizon}: {len(case.own[0])} samples")
        for name, make in ways(case).items():
            began = time.perf_counter()
            model = make()
            took = time.perf_counter() - began
            free, step = fits(model, case.fresh, case.by_variance)
            stable = "" if model.is_stable else "  UNSTABLE"
            print(f"  {name:30s} free run {free:7.2f}  one step {step:6.2f}  {1e3 * took:7.0f} ms{stable}", flush=True)
            if model.is_stable:
                best = np.maximum(best, (free, step))
        reached = [
            "reached" if ours >= peer - ROUNDING else f"SHORT by {peer - ours:.2f}"
            for ours, peer in zip(best, case.sketches, strict=True)
        ]
        print(f"  {'best of ours':30s} free run {best[0]:7.2f}  one step {best[1]:6.2f}")
        print(f"  {'best stable package':30s} free run {case.packages[0]:7.2f}  one step {case.packages[1]:6.2f}")
        print(f"  {'or sketch':30s} free run {case.sketches[0]:7.2f}  one step {case.sketches[1]:6.2f}  ", end="")
        print(f"free run {reached[0]}, one step {reached[1]}")


if __name__ == "__main__":
    main()

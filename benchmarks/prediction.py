"""Predicted beside observed: from which shot on the objective holds, on ten simulated vibrators.

`python -m benchmarks.prediction [LAW [SEED ...]]`, about half a minute a seed.  Models are calibrated by multisine;
`vibractl predict` sees the model and the rig file alone.  The priors of `vibractl.predict.plant` were read off seeds 11
to 20, so that seeds 1 to 10 say how good the prediction is.
"""

import sys

import numpy as np

from benchmarks.direct import met, shots
from benchmarks.identification import found_by
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.predict.learning import forecast
from vibractl.predict.prediction import RUNS
from vibractl.setup import setup

SEEDS = range(1, 11)
NEAR = 3


def main(law: str, seeds: list[int]) -> None:
    near = within = 0
    print(f"law {law}\nseed  predicted, 10 to 90 %     observed")
    for seed in seeds:
        settings = (f"learning.law={law}", f"simulator.options.seed={seed}")
        made = setup(rig_file.load(None, RigConfig, settings), found_by(("method=multisine",), seed).matrix, False)
        predicted = forecast(made, RUNS, lambda _: None)
        seen = met([marks for _, marks in shots(made, made.config.session.shots)])
        observed = np.inf if seen is None else float(seen)
        low, middle, high = (predicted.quantile(part) for part in (0.1, 0.5, 0.9))
        near += middle == observed or bool(abs(middle - observed) <= NEAR)
        within += low <= observed <= high
        print(f"{seed:4d}  {middle:9.0f}, {low:g} to {high:<10g} {observed:8.0f}", flush=True)
    print(f"within {NEAR} shots: {near} of {len(seeds)}; within 10 to 90 %: {within} of {len(seeds)}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "kalman", [int(text) for text in sys.argv[2:]] or list(SEEDS))

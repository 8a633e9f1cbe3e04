"""Predicted beside observed: from which shot on the objective holds, on ten simulated vibrators.

`python -m benchmarks.prediction [SEED ...] [--write]`, a minute a seed; prints the table of `docs/predict.md`.  Models
are calibrated by multisine; `vibractl predict` sees the model and the rig file alone.  The priors of
`vibractl.predict.plant` were read off seeds 11 to 20, so that seeds 1 to 10 say how good the prediction is.
"""

from dataclasses import dataclass

from benchmarks.direct import met, shots
from benchmarks.learning_seeds import identified
from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, table, told, words
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.predict.learning import forecast
from vibractl.predict.prediction import RUNS
from vibractl.setup import setup

LAWS = ("kalman", "thesis")
SEEDS = range(1, 11)
NEAR = 3
BEYOND = "beyond 30"


@dataclass(frozen=True)
class Prediction:
    """Shots to the objective, infinite beyond the run: 10 %, median and 90 % of those predicted, and the observed."""

    low: float
    middle: float
    high: float
    observed: float

    @property
    def near(self) -> bool:
        """Whether the median is right within `NEAR` shots."""
        return self.middle == self.observed or bool(abs(self.middle - self.observed) <= NEAR)

    @property
    def within(self) -> bool:
        """Whether the observed shot lies in the predicted interval."""
        return self.low <= self.observed <= self.high


def of_seed(seed: int) -> list[Prediction]:
    """Predict for one vibrator by every law, and let it learn."""
    own, found = (f"simulator.options.seed={seed}",), []
    for law in LAWS:
        made = setup(rig_file.load(None, RigConfig, (*own, f"learning.law={law}")), identified(own).matrix, False)
        quantile = forecast(made, RUNS, lambda _: None).quantile
        observed = met([heard.over for heard in shots(made, made.config.session.shots)])
        found.append(Prediction(quantile(0.1), quantile(0.5), quantile(0.9), observed))
    return found


def main(seeds: list[int]) -> None:
    found = list(over_seeds(of_seed, seeds))
    head, rows = ["seed"], [[str(seed)] for seed in seeds]
    last = ["right"]
    for number, law in enumerate(LAWS):
        head += [f"{law}: predicted, median", "10 to 90 %", "observed"]
        of_law = [of[number] for of in found]
        for row, each in zip(rows, of_law, strict=True):
            shots_of = (each.low, each.middle, each.high, each.observed)
            low, middle, high, observed = (told(shot, never=BEYOND) for shot in shots_of)
            row += [middle, f"{low} to {high}", observed]
        near, within = (sum(getattr(each, name) for each in of_law) for name in ("near", "within"))
        last += [f"{near} of {len(seeds)} within {NEAR} shots", f"{within} of {len(seeds)}", ""]
    put(table(head, [*rows, last]), "predict.md", "prediction")


if __name__ == "__main__":
    main([int(text) for text in words()] or list(SEEDS))

"""The registry of experiments: every kind of run that the one runner knows, by the name in its `run.json`."""

from rigkit.experiment.kind import Kind
from stagectl.experiments.feed.read_back import FORCE
from stagectl.experiments.midranging.read_back import MIDRANGING
from stagectl.experiments.step.experiment import STEPS
from stagectl.experiments.toroid.read_back import TOROID
from stagectl.experiments.trials.read_back import TRIALS

KINDS: dict[str, Kind] = {kind.name: kind for kind in (FORCE, MIDRANGING, STEPS, TOROID, TRIALS)}

"""Every kind of run that the one runner knows, by the name in its `run.json`."""

from rigkit.code_name import resolve
from rigkit.experiment.kind import Kind
from stagectl.experiments.registry import EXPERIMENTS

KINDS: dict[str, Kind] = {kind.name: kind for kind in (resolve(each.kind) for each in EXPERIMENTS if each.kind)}

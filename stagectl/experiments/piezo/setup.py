"""What a rig file and its models make together: everything a run, its replay and its report start from."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from calibration.state_space.model import InnovationModel
from ctlblocks import Block
from stagectl.config import StageConfig
from stagectl.experiments.piezo.lasers import lateness
from stagectl.experiments.piezo.prefilter_file import read_prefilters
from stagectl.experiments.piezo.timeline import Timeline, timeline
from stagectl.models.model_file import read_measured, read_model
from stagectl.stage.controller import StageController
from stagectl.stage.design import Design, design
from stagectl.stage.hysteresis_compensation import HysteresisCompensation
from stagectl.stage.hysteresis_file import read_hysteresis
from stagectl.stage.loop import stage_controller
from stagectl.stage.measured_response import MeasuredResponse
from stagectl.stage.prefilter import Prefilter, refuse_unfit
from stagectl.stage.state_feedback import StateFeedback
from stagectl.stage.weights import chosen_weights


@dataclass(frozen=True)
class Setup:
    """A run before its first sample.

    Parameters
    ----------
    config : StageConfig
    models : tuple of InnovationModel
    designs : tuple of Design
        One of each an axis; none of a live run on the loops that the stage has already.
    prefilters : tuple of Prefilter or None
        One of each an axis, for a deflection that is compensated; none where there are none.
    measured : tuple of MeasuredResponse or None
        What was heard of each axis, where its model's file says so.
    loops : tuple of StateFeedback
        Of a run that is made again: those that were used, in place of designs.
    held : int, samples
        By which the run was longer, since its reference was held.
    said : tuple of str
        What a person should know of its models, a line each.
    """

    config: StageConfig
    models: tuple[InnovationModel, ...]
    designs: tuple[Design, ...]
    prefilters: tuple[Prefilter | None, ...] = ()
    measured: tuple[MeasuredResponse | None, ...] = ()
    loops: tuple[StateFeedback, ...] = ()
    held: int = 0
    said: tuple[str, ...] = ()

    @property
    def timeline(self) -> Timeline:
        """When what happens; a live run has only to wait until the stage has come to the reference."""
        whole, held = timeline(self.config), self.held
        if not self.config.session.live:
            return replace(whole, end=whole.end + held, total=whole.total + held)
        begin = round(2.5 * self.config.limits.ramp * whole.rate)
        end = begin + whole.end - whole.begin + held
        return Timeline(whole.rate, 0, begin, end, end)

    @property
    def outer_loops(self) -> list[StateFeedback]:
        """The loops that were designed, or of a run that is made again those that were used."""
        return list(self.loops) or [each.loop for each in self.designs]

    def loops_for(self, prefiltered: bool) -> list[StateFeedback]:
        """Return the outer loops; with `prefiltered`, those that the prefilters are made for.

        Parameters
        ----------
        prefiltered : bool
        """
        loops = self.outer_loops
        for axis, each in enumerate(self.prefilters if prefiltered else ()):
            if each is not None:
                loops[axis] = replace(loops[axis], forward=each.forward)
        return loops

    def controller(self, prefiltered: bool = False) -> StageController:
        """Return the controllers, at their beginning, around the loops of `loops_for`."""
        return stage_controller(self.config, self.loops_for(prefiltered))

    def compensation(self) -> Block | None:
        """Return what undoes the hysteresis, or None."""
        files = self.config.inner.hysteresis
        return HysteresisCompensation([read_hysteresis(Path(file)) for file in files]) if files else None


def setup(config: StageConfig, files: Sequence[Path]) -> Setup:
    """Read the models and design the outer loops.

    Parameters
    ----------
    config : StageConfig
    files : sequence of Path
        Model files, one an axis, in the order of `stage.axes`; of a live run, none as well.

    Raises
    ------
    ValueError : there are not as many as axes, a file is no model of one input and one output at the stage's rate, or
        no design keeps its bounds; or a file of prefilters is none of this stage.
    """
    axes = config.stage.axes
    if len(files) != len(axes) and (files or not config.session.live):
        raise ValueError(
            f"there are {len(files)} model files, must be one for each of the axes {', '.join(axes)}, in this order: "
            "--model FILE for each, as `calibrate stage` writes them"
        )
    models = tuple(read_model(file, rate=config.stage.rate) for file in files)
    designs = (
        design(model, config.outer, axis, chosen_weights(config.weights, axis)) for axis, model in enumerate(models)
    )
    made = Setup(config, models, tuple(designs), measured=tuple(read_measured(file) for file in files))
    file = config.deflection.prefilter
    return with_prefilters(made, Path(file)) if file else made


def with_prefilters(made: Setup, file: Path) -> Setup:
    """Return a setup with the prefilters of a file; ValueError where it has none for these axes at this rate."""
    found = read_prefilters(file, made.config.stage.axes, made.config.stage.rate)
    return replace(made, prefilters=found)


def refuse_unfit_prefilters(made: Setup) -> None:
    """Refuse, by ValueError, prefilters with which a loop would not keep its bounds."""
    config = made.config
    for at, each in enumerate(made.prefilters):
        if each is not None:
            name = f"{config.deflection.prefilter}: the prefilter of {config.stage.axes[at]}"
            late = lateness(config)
            refuse_unfit(each, made.designs[at], config.outer, late, name, made.measured[at])

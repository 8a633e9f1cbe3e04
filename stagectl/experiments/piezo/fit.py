"""A new run's setup, and what is refused of it before anything is written."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from pathlib import Path

from stagectl.config import StageConfig
from stagectl.experiments.piezo.lasers import refuse_unfit_lasers
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.setup import Setup, refuse_unfit_prefilters, setup
from stagectl.models.model_origin import refuse_foreign


def new_setup(config: StageConfig, models: Sequence[Path], accept: Collection[str] = ()) -> Setup:
    """Return the setup of a new run, fit to be run.

    Parameters
    ----------
    config : StageConfig
    models : sequence of Path
        Model files, one an axis; of a live run, none as well.
    accept : collection of str
        Keys in which the stage that models were measured on may differ.

    Raises
    ------
    ValueError : models, reference and settings do not fit together.
    """
    made = setup(config, models)
    made = replace(made, said=tuple(refuse_foreign(config, models, made.models, accept)))
    refuse_unfit(made)
    return made


def refuse_unfit(made: Setup) -> None:
    """Refuse, by ValueError, reference and settings that do not fit together."""
    config = made.config
    if config.session.live and config.inner.hysteresis:
        raise ValueError(
            "inner.hysteresis is set, must not be where session.live is true: the stage's processor undoes no "
            "hysteresis; the simulated stage does"
        )
    refuse_unfit_lasers(config)
    if config.deflection.prefilter and not made.designs:
        raise ValueError("deflection.prefilter is set, must not be without models: it belongs to loops made of them")
    wanted_position(config, made.timeline)
    made.compensation()
    if made.prefilters:
        refuse_unfit_prefilters(made)

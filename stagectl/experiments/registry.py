"""The experiments of `stagectl`, an entry each: read by command line, daemon, report, replay, docs/experiments.md."""

from rigkit.experiment.registration import Registration, Served

_HELD = "The robot is held where it is, within limits.stop, as by a STOP; the recording is stored. The rig stays armed."
_AT_ONCE = "It ends at once; the recording is stored. Live, the robot is held and the stage goes to mid-travel."

STAGE = (
    Registration(
        "run",
        "the piezo stage",
        "stage.md",
        "stagectl.experiments.piezo.command:run_command",
        "stagectl.experiments.piezo.experiment:STAGE_RUN",
    ),
)
"""Of the stage alone."""
CELL = (
    Registration(
        "midrange",
        "a position shared by robot and stage",
        "midranging.md",
        "stagectl.experiments.midranging.command:midrange",
        "stagectl.experiments.midranging.read_back:MIDRANGING",
        Served(
            "Share a position, macro and micro",
            "s",
            _AT_ONCE,
            "stagectl.experiments.midranging.options:MidrangeOptions",
            "stagectl.experiments.midranging.daemon:procedure",
        ),
    ),
    Registration(
        "step",
        "steps on robot and stage",
        "midranging.md#identifying-the-pair",
        "stagectl.experiments.step.served:step",
        "stagectl.experiments.step.experiment:STEPS",
        Served(
            "Step responses of robot and stage",
            "s",
            _AT_ONCE,
            "stagectl.experiments.step.served:StepOptions",
            "stagectl.experiments.step.served:procedure",
        ),
    ),
    Registration(
        "cell",
        "the toroid in steel",
        "cell.md",
        "stagectl.experiments.toroid.command:cell",
        "stagectl.experiments.toroid.read_back:TOROID",
        Served(
            "Mill the toroid in steel",
            "s",
            _HELD,
            "stagectl.experiments.toroid.options:CellOptions",
            "stagectl.experiments.toroid.daemon:procedure",
            "This setup is run to its end; the next one waits for resume.",
        ),
    ),
    Registration(
        "ilc",
        "learning to mill",
        "ilc.md",
        "stagectl.experiments.trials.command:ilc",
        "stagectl.experiments.trials.read_back:TRIALS",
        Served(
            "Learn to mill",
            "s",
            "This trial is finished and stored; the run can be resumed. STOP lifts the tool out of the block at once.",
            "stagectl.experiments.trials.options:IlcOptions",
            "stagectl.experiments.trials.daemon:procedure",
            "This trial is finished and stored; the tool is clear of the block until resume, with a fresh block.",
        ),
    ),
    Registration(
        "force",
        "milling by force",
        "force-control.md",
        "stagectl.experiments.feed.command:force",
        "stagectl.experiments.feed.read_back:FORCE",
        Served(
            "Mill by force",
            "cells",
            _HELD,
            "stagectl.experiments.feed.options:ForceOptions",
            "stagectl.experiments.feed.daemon:procedure",
            "This pocket is milled to its end; the next one waits for resume.",
        ),
    ),
)
"""Of the robot cell."""
EXPERIMENTS = (*STAGE, *CELL)

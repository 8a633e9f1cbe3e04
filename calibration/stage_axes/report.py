"""What an axis' calibration found: rows of tables, the figures of `--json`, and a report to look at."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from calibration.identification.figures import residual_figure
from calibration.identification.report import MODE_HEAD, identification_figures, mode_rows, verdicts
from calibration.identification.workflow import Identification
from calibration.stage_axes.calibration import AxisCalibration
from calibration.stage_axes.figures import coupling_figure, free_run_figure, order_figure, response_figure
from rigkit.figure_style import styled
from rigkit.report import Fact, Plot, Report, Section, Table
from stagectl.stage.design import Design

MODEL_HEAD = ("model", "order", "fresh, free run, %", "one step, %", "modes, Hz")
INNER_HEAD = ("axis", "inner.gain, m/V", "inner.bandwidth, Hz", "Ms", "crossover, Hz", "phase margin, degrees")
OUTER_HEAD = (
    "axis",
    "bandwidth, Hz",
    "drive",
    "Ms",
    "Ms, mistuned",
    "phase margin, degrees",
    "crossover, Hz",
    "beyond",
    "left",
)


def models_of(found: AxisCalibration) -> dict[str, Identification]:
    """Return the models by what they are of."""
    return {
        "stack, voltage to extension": found.opened.stack,
        "open, voltage to position": found.opened.one,
        "open, voltage to all positions": found.opened.every,
        "closed, reference to position": found.closed.one,
        "closed, reference to all positions": found.closed.every,
    }


def model_rows(found: AxisCalibration) -> list[tuple[str, ...]]:
    """Return a row for each model: how well it does on the fresh chirp, and its oscillating modes."""
    return [
        (
            f"{found.axis}: {name}",
            f"{each.model.order}",
            _per_output(each.fresh.free_run.nrmse),
            _per_output(each.fresh.one_step.nrmse),
            ", ".join(f"{frequency:.2f}" for frequency, _ in oscillating(each)),
        )
        for name, each in models_of(found).items()
    ]


def inner_row(found: AxisCalibration) -> tuple[str, ...]:
    """Return the PID as the rig file says it, and how robust it is."""
    inner, figures = found.opened.inner, found.opened.robustness
    return (
        found.axis,
        f"{inner.gain[0]:.4g}",
        f"{inner.bandwidth[0]:g}",
        f"{figures.max_sensitivity:.2f}",
        f"{figures.crossover:.1f}",
        f"{figures.phase_margin:.0f}",
    )


def outer_row(found: AxisCalibration) -> tuple[str, ...]:
    """Return the outer loop's integral bandwidth and drive, how robust it is, and what error it leaves."""
    if isinstance(found.outer, str):
        return (found.axis, *["none"] * (len(OUTER_HEAD) - 3), f"{found.allowed:g}", "none")
    weights, figures = found.outer.weights, found.outer.robustness
    return (
        found.axis,
        f"{weights.bandwidth:g}",
        f"{weights.drive:g}",
        f"{figures.max_sensitivity:.2f}",
        f"{found.outer.worst_sensitivity:.2f}",
        f"{figures.phase_margin:.0f}",
        f"{figures.crossover:.0f}",
        f"{found.outer.beyond:.3g}",
        f"{found.outer.left:.2f}",
    )


def without_loop(found: Sequence[AxisCalibration]) -> list[str]:
    """Return a line for each axis that has no outer loop: why."""
    return [f"no outer loop on {each.axis}: {each.outer}" for each in found if isinstance(each.outer, str)]


def oscillating(found: Identification) -> list[tuple[float, float]]:
    """Return natural frequency (Hz) and damping ratio of the modes that oscillate."""
    modes = found.model.modes
    pairs = zip(modes.frequency.tolist(), modes.damping.tolist(), strict=True)
    return [(frequency, damping) for frequency, damping in pairs if abs(damping) < 1]


def calibration_figures(found: Sequence[AxisCalibration]) -> dict[str, Any]:
    """Return what `--json` writes."""
    return {
        each.axis: {
            "inner": {
                "gain": each.opened.inner.gain[0],
                "bandwidth_hz": each.opened.inner.bandwidth[0],
                "max_sensitivity": each.opened.robustness.max_sensitivity,
                "crossover_hz": each.opened.robustness.crossover,
                "phase_margin_deg": each.opened.robustness.phase_margin,
            },
            "outer": _outer_figures(each.outer) | {"allowed": each.allowed},
            "amplitude": {"voltage": each.opened.experiment.amplitude, "reference": each.closed.experiment.amplitude},
            "seconds": each.opened.experiment.seconds + each.closed.experiment.seconds,
            **{name: identification_figures(model) for name, model in _keyed(each).items()},
        }
        for each in found
    }


def _outer_figures(outer: Design | str) -> dict[str, Any]:
    if isinstance(outer, str):
        return {"none": outer}
    figures = outer.robustness
    return asdict(outer.weights) | {
        "beyond": outer.beyond,
        "max_sensitivity": figures.max_sensitivity,
        "mistuned_sensitivity": outer.worst_sensitivity,
        "phase_margin_deg": figures.phase_margin,
        "delay_margin_s": figures.delay_margin,
        "crossover_hz": figures.crossover,
        "left": outer.left,
    }


def axis_report(found: AxisCalibration, rig: str) -> Report:
    """Put the report of an axis together."""
    one, figures = found.closed.one, found.opened.robustness
    facts = (
        Fact("order, closed loop", f"{one.model.order}"),
        Fact("free run on fresh data, closed loop", f"{one.fresh.free_run.nrmse[0]:.2f} %"),
        Fact("free run on fresh data, open loop", f"{found.opened.one.fresh.free_run.nrmse[0]:.2f} %"),
        Fact("Ms of the inner loop", f"{figures.max_sensitivity:.2f}"),
    )
    with styled():
        sections = (*_fits(found), *_quality(found))
    return Report(f"Stage, axis {found.axis}", f"{rig}, by {one.method}, {one.model.rate:g} samples/s", facts, sections)


def _fits(found: AxisCalibration) -> tuple[Section, ...]:
    return (
        Section(
            "Order",
            "The order is at the largest gap in the singular values, of the orders whose free run on the validation "
            "chirp is within the dashed margin of the best.",
            (Plot(order_figure(found), "Above: singular values, in the model and left out. Below: fits."),),
            (Table(MODEL_HEAD, tuple(model_rows(found))),),
        ),
        Section(
            "Frequency response",
            "Welch's estimate is from the validation chirp, to which the model was not fitted.",
            (Plot(response_figure(found), "Left: with open inner loop; right: with closed."),),
        ),
        Section(
            "Cross coupling",
            "From the inner loop's reference to the positions of all axes.",
            (Plot(coupling_figure(found), "Dots: Welch; lines: the model of one input and all positions."),),
        ),
        Section(
            "Free run on fresh data",
            "The response to the drive alone.",
            (Plot(free_run_figure(found), "Measured, modelled, and the difference; in the title the NRMSE fit."),),
        ),
    )


def _quality(found: AxisCalibration) -> tuple[Section, ...]:
    one, figures = found.closed.one, found.opened.robustness
    outer = found.outer if isinstance(found.outer, str) else str(found.outer.robustness)
    return (
        Section(
            "Residuals",
            ". ".join(sentence[0].upper() + sentence[1:] for sentence in verdicts(one)) + ".",
            (Plot(residual_figure(one), "Closed loop, one step ahead. Dashed: chance, one time in a hundred."),),
        ),
        Section("Inner loop", str(figures), (), (Table(INNER_HEAD, (inner_row(found),)),)),
        Section("Outer loop", outer, (), (Table(OUTER_HEAD, (outer_row(found),)),)),
        Section(
            "Modes",
            "Of the closed loop's model of thinned records; +- is one standard error, by a jackknife of segments.",
            (),
            (Table(MODE_HEAD, tuple(mode_rows(one))),),
        ),
    )


def _keyed(found: AxisCalibration) -> dict[str, Identification]:
    names = ("stack", "open", "open_all", "closed", "closed_all")
    return dict(zip(names, models_of(found).values(), strict=True))


def _per_output(fits: Any) -> str:
    return ", ".join(f"{fit:.2f}" for fit in fits)

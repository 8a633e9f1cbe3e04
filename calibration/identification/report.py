"""What an identification found: rows of tables, the figures of `--json`, and a report to look at."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from calibration.fit_measures import Fit
from calibration.identification.figures import free_run_figure, residual_figure, singular_value_figure
from calibration.identification.workflow import Identification
from calibration.subspace.order import Candidate
from calibration.subspace.telling import known
from rigkit.figure_style import styled
from rigkit.report import Fact, Plot, Report, Section, Table

FIT_HEAD = ("output", "free run NRMSE, %", "VAF, %", "MAE", "one step NRMSE, %", "VAF, %", "MAE", "from rest, %")
MODE_HEAD = ("pole", "natural frequency, Hz", "+-", "damping ratio", "+-")
CANDIDATE_HEAD = ("order tried", "at horizon", "free run, %", "one step, %")
NEARLY_HEAD = ("inputs nearly go together, Hz", "inputs", "weakest combination over strongest, power")

_UNSEEN = "the model has not seen these samples."
_FREE_RUN = "Free run on validation data", f"The response to the drive alone; {_UNSEEN}"
_PREDICTION = "Prediction on validation data", f"Each sample from those before it; {_UNSEEN}"

ONE_IN_20 = 0.05
CROSSED = 0.05
"""Share of correlations with the drive beyond their bound of one in a hundred, up to which they are called none."""


def fit_table(found: Identification) -> Table:
    """Return a row for each output: fits on fresh data; of a time series, which has no free run, one step ahead."""
    table = Table(FIT_HEAD, tuple(_fit_rows(found)))
    return table if found.model.inputs else _without(table, range(1, 4))


def candidate_table(found: Identification) -> Table:
    """Return a row for each order tried, at the horizon where it did best; none where both were given."""
    table = Table(CANDIDATE_HEAD, tuple(_candidate_rows(found)))
    return table if found.started.candidates_ran_free else _without(table, range(2, 3))


def _without(table: Table, columns: range) -> Table:
    """Leave columns out."""
    kept = [each for each in range(len(table.head)) if each not in columns]
    return Table(
        tuple(table.head[each] for each in kept), tuple(tuple(row[each] for each in kept) for row in table.rows)
    )


def _fit_rows(found: Identification) -> list[tuple[str, ...]]:
    free, step = found.fresh.free_run, found.fresh.one_step
    return [
        (
            name,
            known(free.nrmse[row], ".2f"),
            known(free.vaf[row], ".3f"),
            known(free.mae[row], ".4g", f" {unit}"),
            f"{step.nrmse[row]:.2f}",
            f"{step.vaf[row]:.3f}",
            f"{step.mae[row]:.4g} {unit}",
            f"{found.fresh.from_rest.nrmse[row]:.2f}",
        )
        for row, (name, unit) in enumerate(zip(found.model.output_names, found.model.output_units, strict=True))
    ]


def mode_rows(found: Identification) -> list[tuple[str, ...]]:
    """Return a row for each mode of the model, with standard errors."""
    errors = found.errors
    modes = errors.modes
    return [
        (
            f"{pole.real:.6f}" if pole.imag == 0 else f"{pole.real:.6f} +- {pole.imag:.6f}i",
            f"{modes.frequency[row]:.5g}",
            f"{errors.frequency[row]:.2g}",
            f"{modes.damping[row]:.5f}",
            f"{errors.damping[row]:.2g}" if pole.imag else "-",
        )
        for row, pole in enumerate(modes.pole)
    ]


def record_notes(found: Identification) -> list[str]:
    """Return sentences on what identification warned of, and on inputs that come late."""
    inputs = zip(found.model.input_names, found.started.delays, strict=True)
    told = [f"{name} by {each} samples" for name, each in inputs if each]
    late = [f"inputs that come late, which the model has as states more: {', '.join(told)}"] if told else []
    return [*found.notes, *late]


def _candidate_rows(found: Identification) -> list[tuple[str, ...]]:
    best: dict[int, Candidate] = {}
    for each in found.started.candidates:
        if each.order not in best or each.error < best[each.order].error:
            best[each.order] = each
    return [
        (f"{each.order}", f"{each.horizon}", f"{each.free_run:.2f}", f"{each.one_step:.2f}") for each in best.values()
    ]


EXPLAINED = 20.0
"""% of an output, NRMSE, below which a model is worth nothing."""


def nearly_rows(found: Identification) -> list[tuple[str, ...]]:
    """Return a row for each band in which inputs nearly go together."""
    rows = ((f"{each.low:.4g} to {each.high:.4g}", ", ".join(each.inputs), each.share) for each in found.nearly)
    return [(band, inputs, f"{share:.1e}") for band, inputs, share in rows]


def verdicts(found: Identification) -> list[str]:
    """Return, in sentences, what the tests of the residuals on fresh data say."""
    white, cross = found.fresh.whiteness, found.fresh.cross_correlation
    noise = "white" if white.probability >= ONE_IN_20 else "not white: the noise model leaves something"
    heard = "none" if cross.outside <= CROSSED else "some: the response has more to it than the model"
    own = (
        f"residuals one step ahead are {noise} (probability {white.probability:.2g}, "
        f"{100 * white.outside:.0f} % of correlations beyond the bound of 1 %)"
    )
    other = f"correlation with the drive: {heard} ({100 * cross.outside:.0f} % beyond the bound of 1 %)"
    return [own, other] if found.model.inputs else [own]


def pair_notes(found: Identification) -> list[str]:
    """Return a sentence where drives and responses seem not to belong together; none where they do, or in a loop."""
    explained = float(found.fresh.free_run.nrmse.max())
    if not found.model.inputs or not explained < EXPLAINED or found.started.feedback.inputs:
        return []
    return [
        f"warning: the free run explains {explained:.0f} % of the output that it explains best: drives and responses "
        "must begin together and have one clock"
    ]


def identification_figures(found: Identification) -> dict[str, Any]:
    """Return what `--json` writes."""
    model, errors, started = found.model, found.errors, found.started
    return {
        "method": found.method,
        "order": found.order,
        "delays": list(started.delays),
        "rate": model.rate,
        "horizon": list(started.horizon),
        "singular_values": started.singular_values,
        "orders_tried": [
            {
                "order": each.order,
                "horizon": each.horizon,
                **({"free_run_nrmse": each.free_run} if model.inputs else {}),
                "one_step_nrmse": each.one_step,
            }
            for each in started.candidates
        ],
        "poles_moved_inside": started.moved_poles,
        "is_stable": model.is_stable,
        "modes": [
            {
                "pole": [float(pole.real), float(pole.imag)],
                "frequency_hz": float(errors.modes.frequency[row]),
                "frequency_error_hz": float(errors.frequency[row]),
                "damping_ratio": float(errors.modes.damping[row]),
                "damping_error": float(errors.damping[row]),
            }
            for row, pole in enumerate(errors.modes.pole)
        ],
        "nearly_collinear": [asdict(each) for each in found.nearly],
        "held_back": _fit_figures(found, found.fresh),
        "identified_from": _fit_figures(found, found.own),
    }


def identification_report(found: Identification, source: str, notes: Sequence[str] = ()) -> Report:
    """Put the report of an identification together, with what is to be said of its recordings."""
    heading, about = _FREE_RUN if found.runs_free else _PREDICTION
    with styled():
        sections = (
            *_of_recordings(found, notes),
            Section(
                "Singular values",
                "Those above the noise are states of the model.",
                (Plot(singular_value_figure(found), "Singular values, and the order taken."),),
            ),
            *_tried(found),
            Section(
                heading,
                about,
                (Plot(free_run_figure(found), "Measured, modelled, and the difference; in the title the NRMSE fit."),),
                (fit_table(found),),
            ),
            Section(
                "Residuals",
                ". ".join(sentence[0].upper() + sentence[1:] for sentence in verdicts(found)) + ".",
                (Plot(residual_figure(found), "Dashed: what chance exceeds one time in a hundred."),),
            ),
            Section(
                "Modes",
                "Poles of the model; +- is one standard error: by pem from the Hessian of the prediction error, else "
                "from the spread of the estimates without each sixteenth of the record in turn.",
                (),
                (Table(MODE_HEAD, tuple(mode_rows(found))),),
            ),
        )
    subtitle = f"{source}, {len(found.response)}validation samples, {found.model.rate:g} samples/s, by {found.method}"
    return Report("Identified model", subtitle, _facts(found), sections)


def _tried(found: Identification) -> tuple[Section, ...]:
    """Return a section on the orders that were tried, where some were."""
    if not found.started.candidates:
        return ()
    about = "What each order left of blocks that it was not identified from; bold: at the horizon that was taken."
    drawn = Plot(found.started.draw_candidates(), "Errors of free run and prediction.")
    return (Section("Orders", about, (drawn,), (candidate_table(found),)),)


def _facts(found: Identification) -> tuple[Fact, ...]:
    """Return what stands above the sections."""
    model, fresh = found.model, found.fresh
    run = Fact("free run on validation data", known(float(fresh.free_run.nrmse.mean()), ".2f", " %"))
    return (
        Fact("order", f"{found.order}"),
        *([run] if model.inputs else []),
        Fact("one step ahead on validation data", f"{fresh.one_step.nrmse.mean():.2f} %"),
        Fact("every pole is stable", "yes" if model.is_stable else "no, as was allowed", model.is_stable or None),
        Fact("residuals are white", f"probability {fresh.whiteness.probability:.2g}"),
    )


def _of_recordings(found: Identification, notes: Sequence[str]) -> tuple[Section, ...]:
    """Return a section where there is something to be said of them."""
    about = "\n\n".join(f"{note[0].upper()}{note[1:]}." for note in (*notes, *record_notes(found)))
    near = (Table(NEARLY_HEAD, tuple(nearly_rows(found))),) if found.nearly else ()
    return (Section("Recordings", about, (), near),) if about or near else ()


def _fit_figures(found: Identification, fit: Fit) -> dict[str, Any]:
    names = found.model.output_names
    kinds = {"free_run": fit.free_run} if found.model.inputs else {}
    kinds |= {"one_step": fit.one_step, "from_rest": fit.from_rest}
    crossed = {"cross_correlations_outside": fit.cross_correlation.outside} if found.model.inputs else {}
    return {
        "outputs": {
            name: {
                f"{kind}_{measure}": float(np.asarray(getattr(each, measure))[row])
                for kind, each in kinds.items()
                for measure in ("nrmse", "vaf", "mae")
            }
            for row, name in enumerate(names)
        },
        "whiteness_probability": fit.whiteness.probability,
        "autocorrelations_outside": fit.whiteness.outside,
        **crossed,
    }

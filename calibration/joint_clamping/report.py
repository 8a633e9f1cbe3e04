"""What clamping found: rows of a table, the figures of `--json`, and a report with the torque-position maps."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from calibration.joint_clamping.full_stiffness import ArmStiffness
from calibration.joint_clamping.joint_model import Estimate, JointModel
from calibration.joint_clamping.results import WAYS, JointResult
from calibration.joint_clamping.several_poses import stiffest
from rigkit.figure_style import COLOURS, styled
from rigkit.report import Fact, Plot, Report, Section, Table

ARM_HEAD = ("joint", "stiffness about its axis, N m/rad", "compliance across, rad/(N m)", "the other, rad/(N m)")
HEAD = ("joint", "arm's side", "spring", "backlash", "k+, N m/rad", "k-, N m/rad", "loop width, N m")


def rows(results: Sequence[JointResult]) -> list[tuple[str, ...]]:
    """Return a row for every joint and way."""
    found = []
    for result in results:
        for way, model in _models(result):
            values = [_said(each) for each in (model.k_plus, model.k_minus)]
            width = f"{model.loop_width:.3g} ± {2 * model.friction.reach * model.friction.error:.2g}"
            found.append((_number(result), way, model.spring, model.backlash_said, *values, width))
    return found


def figures(results: Sequence[JointResult], whole: ArmStiffness | str | None) -> dict[str, Any]:
    """Return what `--json` writes: estimate and interval of every figure, SI.

    Parameters
    ----------
    results : sequence of JointResult
    whole : ArmStiffness, str or None
        What several poses say of the arm, or why they do not; None where there was one.

    Returns
    -------
    dict
        `joint_1` ...: figures by way, of the pose in which the joint looks stiffest; of several poses, `poses`: all of
        them, and `arm`: `own` (rad/(N m)) and `tilting`, each with its interval, or the reason why there are none.
    """
    found: dict[str, Any] = {f"joint_{each.joint + 1}": _by_way(each) for each in stiffest(results)}
    if whole is None:
        return found
    found["poses"] = [{"joint": each.joint + 1, "pose": each.pose, **_by_way(each)} for each in results]
    return found | {"arm": {"reason": whole} if isinstance(whole, str) else _compliances(whole)}


def joints_report(results: Sequence[JointResult], whole: ArmStiffness | str | None, source: str) -> Report:
    """Put the report together: a map a joint and pose, and the arm's compliances.

    Parameters
    ----------
    results, whole : as of `figures`
    source : str
        What was measured.
    """
    facts = tuple(Fact(f"joint {_number(each)}: backlash", each.best[1].backlash_said) for each in stiffest(results))
    with styled():
        sections = [
            Section(
                f"Joint {_number(result)}",
                _words(result),
                (Plot(_map(result), "Torque over the motor's angle, from the backlash's middle; dashed: the spring."),),
                (Table(HEAD, tuple(rows([result]))),),
            )
            for result in results
        ]
    if isinstance(whole, str):
        sections.append(Section("The whole arm", whole))
    elif whole is not None:
        sections.append(Section("The whole arm", _about(whole), (), (Table(ARM_HEAD, tuple(arm_rows(whole))),)))
    return Report("Joints of a clamped arm", source, facts, tuple(sections))


def arm_rows(whole: ArmStiffness) -> list[tuple[str, ...]]:
    """Return a row a joint: stiffness about its axis, and both compliances across it."""
    found = []
    for joint, (own, across) in enumerate(zip(whole.own, whole.tilting, strict=True), start=1):
        shown = ["not told apart" if each is None else _said(each) for each in across]
        found.append((str(joint), f"{1 / own.value:.4g} ± {own.reach * own.error / own.value**2:.2g}", *shown))
    return found


def _about(whole: ArmStiffness) -> str:
    return f"From the slopes of all poses together; {100 * whole.misfit:.2g} % of the torques are left."


def _compliances(whole: ArmStiffness) -> dict[str, Any]:
    def one(each: Estimate | None) -> dict[str, Any] | None:
        return None if each is None else {"value": each.value, "interval": [each.low, each.high]}

    tilting = [[one(each) for each in pair] for pair in whole.tilting]
    return {"own": [one(each) for each in whole.own], "tilting": tilting, "misfit": whole.misfit}


def _number(result: JointResult) -> str:
    return f"{result.joint + 1}, pose {result.pose}" if result.pose else str(result.joint + 1)


def _by_way(result: JointResult) -> dict[str, Any]:
    return {way: _figures(model) for way, model in _models(result)}


def _models(result: JointResult) -> list[tuple[str, JointModel]]:
    return [(way, result.models[way]) for way in WAYS if way in result.models]


def _said(each: Estimate) -> str:
    return f"{each.value:.5g} ± {each.reach * each.error:.2g}"


def _figures(model: JointModel) -> dict[str, Any]:
    names = ("backlash", "k_plus", "k_minus", "cubic_plus", "cubic_minus", "friction", "friction_load")
    found: dict[str, Any] = {"spring": model.spring, "has_backlash": model.has_backlash}
    for name in names:
        each: Estimate = getattr(model, name)
        found |= {name: each.value, f"{name}_interval": [each.low, each.high]}
    return found | {
        "backlash_bound": model.backlash_bound,
        "loop_width": model.loop_width,
        "residual": model.residual,
        "torque_range": list(model.torque_range),
        "cycles": model.cycles,
    }


def _words(result: JointResult) -> str:
    way, model = result.best
    low, high = model.torque_range
    text = f"Over {model.cycles:g} cycles between {low:.3g} and {high:.3g} N m, {model.residual:.2g} N m are left."
    first = result.models[WAYS[0]]
    if way != WAYS[0]:
        share = 100 * (1 - first.k_plus.value / model.k_plus.value)
        text += f"\n\nWithout allowing for the arm's side, k+ would have come out {share:.1f} % less."
    return text


def _map(result: JointResult) -> Figure:
    figure = Figure(figsize=(8.0, 5.0))
    axes = figure.subplots()
    thin = result.map.thinned()
    first = result.models[WAYS[0]]
    axes.plot(1e3 * (thin.angle - first.centre), thin.torque, color="0.6", linewidth=0.8, label="measured")
    for number, (way, model) in enumerate(_models(result)):
        low, high = model.torque_range
        angle = np.linspace(-1, 1, 401) * np.ptp(thin.angle)
        torque = model.spring_torque(model.centre + angle)
        shown = (torque >= low) & (torque <= high)
        axes.plot(1e3 * angle[shown], torque[shown], "--", color=COLOURS[number], label=f"spring, {way}")
    axes.set(xlabel="angle (mrad)", ylabel="torque (N m)")
    axes.legend()
    return figure

"""What the bounds on an outer loop are about, looked at quickly, on one set of frequencies, for many loops."""

from dataclasses import dataclass, replace

import numpy as np

from stagectl.config import Outer
from stagectl.stage.allowed_gains import AllowedGains, frequencies_above
from stagectl.stage.measured_response import SMALL, MeasuredResponse
from stagectl.stage.sensitivity import frequencies, is_stable
from stagectl.stage.state_feedback import StateFeedback
from stagectl.stage.state_space import StateSpace

NEAR = np.geomspace(0.85, 1.0 / 0.85, 41)
"""Of a resonance's frequency: where pushes are looked at, since a loop moves it."""
SLOWER, FASTER = 10.0, 3.0
"""How many times slower than `Outer.disturbance` pushes are; how many times faster, and smaller, references are too.
The second of the forces that `Outer.compliance` counts is as many times slower."""
USELESS = 1.35
"""Error left, where no loop at all leaves 1.45: whoever asks for a loop does not want one of more.  Answers to
forces are added to both."""


@dataclass(frozen=True)
class Reached:
    """What of the bounded a loop reaches; infinite where it is not stable.

    Parameters
    ----------
    beyond, forward_beyond : float, 1
        Largest gain of the controller above `Outer.reach`, from the error and from the reference, re the plant at rest.
    beyond_share, forward_share : float, 1
        Of the gains that are allowed at each frequency there, the largest.
    sensitivity, mistuned_sensitivity : float, 1
        Ms with the extra delay; and with natural frequencies off as well.
    answer : float, 1
        Largest answer to a reference, frequencies off or not.
    heard_sensitivity, compensation : float, 1
        Ms, and the largest gain of the loop that a deflection's compensation is, on the plant as it was heard.
    """

    beyond: float
    forward_beyond: float
    beyond_share: float
    forward_share: float
    sensitivity: float = 0.0
    mistuned_sensitivity: float = 0.0
    answer: float = 0.0
    heard_sensitivity: float = 0.0
    compensation: float = 0.0

    @property
    def is_looked_at(self) -> bool:
        """Whether it was good enough above `Outer.reach` for the rest to be looked at."""
        return max(self.sensitivity, self.heard_sensitivity) > 0.0

    def over(self, outer: Outer) -> float:
        """Return the largest of these re its bound."""
        return max(self._shares(outer).values())

    def binding(self, outer: Outer) -> str:
        """Say which bound is exceeded most, and what would be changed for it."""
        shares = self._shares(outer)
        return max(shares, key=lambda each: shares[each])

    def _shares(self, outer: Outer) -> dict[str, float]:
        """Return what is reached re its bound, by what to do about it."""
        return {
            "the controller's gain above outer.reach: calibrate with a wider characterisation.band and raise "
            "outer.reach with it, or lower outer.disturbance": self.beyond_share,
            "the gain from the reference above outer.reach: lower outer.feedforward or outer.disturbance": (
                self.forward_share
            ),
            "Ms: lower outer.delay, outer.bandwidth or outer.disturbance, or raise outer.max_sensitivity": (
                self.sensitivity / outer.max_sensitivity
            ),
            "Ms or the answer to a reference where natural frequencies are off: lower outer.mistuning, or raise "
            "outer.mistuned_sensitivity": max(self.mistuned_sensitivity, self.answer) / outer.mistuned_sensitivity,
            "Ms on the measured response of the plant, not on its model: lower outer.disturbance, or calibrate with "
            "another --order": self.heard_sensitivity / outer.mistuned_sensitivity,
            "the loop that a deflection's compensation is, where laser and plate's sensor do not see the plate alike: "
            "is deflection.delay right? else lower outer.feedforward or outer.disturbance": self.compensation / SMALL,
        }

    def __str__(self) -> str:
        """Say it in one line."""
        gains = (
            f"gains {self.beyond:.2g} and, from the reference, {self.forward_beyond:.2g} above outer.reach, "
            f"{self.beyond_share:.2g} and {self.forward_share:.2g} of those allowed"
        )
        if self.heard_sensitivity > 0.0:
            gains += f", measured Ms {self.heard_sensitivity:.2f}, compensation {self.compensation:.2f} of {SMALL:g}"
        if self.sensitivity == 0.0:
            return gains
        return (
            f"{gains}, Ms {self.sensitivity:.2f}, mistuned "
            f"{self.mistuned_sensitivity:.2f}, answer to a reference {self.answer:.2f}"
        )


class Looks:
    """A quick look at many controllers of one plant, as it is and with natural frequencies off.

    Parameters
    ----------
    plants : list of StateSpace
        The first is the one that the loops are made for.
    rate : float, samples/s
    outer : Outer
    allowed : AllowedGains
        Above `Outer.reach`.
    measured : MeasuredResponse, optional
        Of the same plant.
    """

    def __init__(
        self,
        plants: list[StateSpace],
        rate: float,
        outer: Outer,
        allowed: AllowedGains,
        measured: MeasuredResponse | None = None,
    ) -> None:
        self._plants, self._rate, self._outer, self._allowed = plants, rate, outer, allowed
        self._measured = measured
        self._frequency = frequencies(plants, rate)[::2]
        self._responses = np.array([plant.response(self._frequency, rate) for plant in plants])
        self._late = np.exp(-2j * np.pi * self._frequency * outer.delay / rate)
        beyond = frequencies_above(outer, rate)
        self._few = np.append(beyond, outer.disturbance * np.array([FASTER, 1.0, 1.0 / FASTER, 1.0 / SLOWER]))
        self._ringing = _around_resonances(plants[0], rate) if outer.push > 0 else np.zeros(0)
        self._ringing_responses = plants[0].response(self._ringing, rate)
        self._at_rest = abs(plants[0].response(np.zeros(1), rate)[0])
        self._few_responses = plants[0].response(self._few, rate)
        self._cut = outer.compliance * self._few_responses[-3:-1] / self._at_rest
        self.useless = float(np.hypot(USELESS, np.linalg.norm(self._cut)))
        """Error left that is too much."""

    def beyond_and_left(self, loop: StateFeedback) -> tuple[Reached, float]:
        """Return what a loop reaches above `Outer.reach`, and `Design.left`."""
        feedback = loop.system().response(self._few, self._rate)
        sensitivity = 1.0 / (1.0 + feedback[-4:] * self._few_responses[-4:])
        forward = loop.reference_system().response(self._few, self._rate)
        missed = np.abs(1.0 - forward[-4:-2] * self._few_responses[-4:-2] * sensitivity[:2])
        gives = np.abs(self._cut * sensitivity[1:3])
        left = np.linalg.norm([missed[0] / FASTER, missed[1], abs(sensitivity[3]), *gives, self._push(loop)])
        gains = [self._at_rest * np.abs(each[:-4]) for each in (feedback, forward)]
        shares = (
            gain / most for gain, most in zip(gains, (self._allowed.feedback, self._allowed.forward), strict=True)
        )
        return Reached(*(float(each.max(initial=0.0)) for each in (*gains, *shares))), float(left)

    def _push(self, loop: StateFeedback) -> float:
        """Return the largest answer to a push at the plant's input, re the plant at rest, times `Outer.push`."""
        plant = self._ringing_responses
        answer = plant / (1.0 + loop.system().response(self._ringing, self._rate) * plant)
        return float(self._outer.push * np.abs(answer).max(initial=0.0) / self._at_rest)

    def reached(self, loop: StateFeedback, beyond: Reached) -> Reached:
        """Return what a loop reaches on all plants, above `Outer.reach` as found already."""
        if self._measured is not None:
            heard = self._measured.answers(loop)
            sensitivity, compensation = (float(each.max()) for each in (heard.sensitivity, heard.compensation))
            beyond = replace(beyond, heard_sensitivity=sensitivity, compensation=compensation)
            if beyond.over(self._outer) > 1.0:
                return beyond
        controller = loop.system()
        gain = controller.response(self._frequency, self._rate) * self._responses
        distance = np.minimum(np.abs(1.0 + gain), np.abs(1.0 + gain * self._late)).min(axis=1)
        answer = loop.reference_system().response(self._frequency, self._rate) * self._responses / (1.0 + gain)
        nearest = 1.0 / distance
        late = [controller.delayed(delay) for delay in {0, self._outer.delay}]
        keeps = (all(is_stable(each.then(plant)) for each in late) for plant in self._plants)  # plant by plant
        if not next(keeps):
            return replace(beyond, sensitivity=np.inf, mistuned_sensitivity=np.inf, answer=np.inf)
        found = replace(beyond, sensitivity=float(nearest[0]), mistuned_sensitivity=np.inf, answer=np.inf)
        if not all(keeps):
            return found
        return replace(found, mistuned_sensitivity=float(nearest.max()), answer=float(np.abs(answer).max()))


def _around_resonances(plant: StateSpace, rate: float) -> np.ndarray:
    """Return frequencies at and around the plant's resonances, shape (bins,), Hz."""
    poles = np.linalg.eigvals(plant.A).astype(complex)
    natural = np.abs(np.log(poles[poles.imag > 0])) * rate / (2 * np.pi)
    return np.asarray(np.unique(np.outer(natural, NEAR)))


def mistuned(plant: StateSpace, factor: float) -> StateSpace:
    """Return a plant whose natural frequencies are multiplied by a factor; damping ratios and gain at rest stay."""
    if factor == 1.0:
        return plant
    poles, shapes = np.linalg.eig(plant.A.astype(complex))
    moved = np.where(np.abs(poles.imag) > 0, np.exp(factor * np.log(poles + (poles == 0))), poles)
    turned = np.linalg.solve(shapes.T, (shapes * moved).T).T.real
    unit = np.eye(len(plant.A))
    return StateSpace(turned, (unit - turned) @ np.linalg.solve(unit - plant.A, plant.B), plant.C, plant.D)


def largest_answer(plant: StateSpace, loop: StateFeedback) -> float:
    """Return the largest gain from reference to position of a loop on a plant, m/m."""
    rate = loop.model.rate
    frequency = frequencies([plant, loop.system().then(plant).closed()], rate)
    response = plant.response(frequency, rate)
    closed = loop.reference_system().response(frequency, rate) * response
    return float(np.abs(closed / (1.0 + loop.system().response(frequency, rate) * response)).max())

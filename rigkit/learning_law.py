"""What every law of learning from trial to trial is: a first thing to ask for, and the next one from each trial."""

from typing import Protocol, TypeVar

Model = TypeVar("Model", contravariant=True)
Belief = TypeVar("Belief", contravariant=True)
Trial = TypeVar("Trial", contravariant=True)
Asked = TypeVar("Asked", covariant=True)


class LearningLaw(Protocol[Model, Belief, Trial, Asked]):
    """A law of iterative learning control.

    It keeps nothing from trial to trial itself: what is known by then is given to it, and so is what was learned.
    Whoever asks it sees to limits, to doubt, and to whether a trial is to be learned from at all.
    """

    def first(self, model: Model) -> Asked:
        """Return what to ask for in the first trial, from what is known of the plant before it."""

    def next(self, belief: Belief, trial: Trial) -> Asked:
        """Return what to ask for in the next trial, from what is known by then and a trial that has ended."""

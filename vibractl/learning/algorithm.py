"""The learning of a run, from shot to shot, in lines: what is believed, dared and watched make the next drive."""

import numpy as np

from vibractl import config
from vibractl.config import Adaptation
from vibractl.learning.belief import Belief
from vibractl.learning.daring import Daring
from vibractl.learning.decision import Decision, tidy
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.law import Law, reference_level
from vibractl.learning.laws import Heard
from vibractl.learning.lookout import Lookout
from vibractl.learning.rollback import Rollback
from vibractl.learning.shot import Shot
from vibractl.learning.soft_start import SoftStart
from vibractl.learning.update import update
from vibractl.learning.warm_start import Check, KnownDrive


class Algorithm:
    """Learns from shot to shot.  With every part of [adaptation] and [watch] off it is the law of the thesis.

    `lines` is the next drive, made to "learn", to "rise", to "reidentify" or to "check": `purpose`.  `belief` is what
    is believed of the vibrator, `daring` has the gains of the update last made and what they promise.  `decisions` are
    those of the last step.

    Parameters
    ----------
    law : Law
    adaptation : Adaptation
    watch : config.Watch
    objective : float, dB
        Limit on errors, re the reference's level.
    known : KnownDrive, optional
        To be checked, and if it fits, to be started from.
    rising : bool array, shape (lines,), optional
        Judged lines of a run that begins faint, and rises as these allow; without them it begins at full level.

    Source
    ------
    Sörnmo 2015, Algorithm 1.
    """

    def __init__(
        self,
        law: Law,
        adaptation: Adaptation,
        watch: config.Watch,
        objective: float,
        known: KnownDrive | None = None,
        rising: np.ndarray | None = None,
    ) -> None:
        self.law, self._known, self._rising, self._objective = law, known, rising, objective
        kind = KINDS[law.settings.law]
        self._law = kind.law
        self._parts = adaptation if kind.follows else adaptation.model_copy(update=_NOTHING)
        self._watching = watch
        self._limit = float(reference_level(law.reference).min()) * 10 ** (objective / 20)
        update(law.start, law.inverse, np.zeros_like(law.reference), 0.0)  # compiles, before a stream is opened
        self.restart()

    def restart(self) -> None:
        """Go back to the first drive."""
        law, parts = self.law, self._parts
        self.number = 0
        self.decisions: list[Decision] = []
        self.belief = Belief(law, parts)
        self.daring = Daring(law, parts.cautious, self.belief)
        self._lookout = Lookout(law, self._watching, self._limit) if self._watching.on else None
        self._rollback = Rollback() if parts.rollback else None
        self._checking = Check(self._known, law.reference, self._limit) if self._known else None
        self._soft: SoftStart | None = None
        self.lines = self._first_drive() if self._checking is None else self._checking.drive

    @property
    def purpose(self) -> str:
        """What the next shot is for."""
        if self._checking is not None:
            return "check"
        if self._soft is not None:
            return "rise"
        return "learn" if self._lookout is None or self._lookout.probing is None else "reidentify"

    @property
    def level(self) -> float:
        """The level of the next drive, 1: below 1 while a known drive is checked, or while the level rises."""
        if self._checking is not None:
            return self._checking.level
        return 1.0 if self._soft is None else self._soft.level

    def step(self, shot: Shot) -> None:
        """Take a shot that was made with `lines`."""
        self.decisions = []
        if self._checking is not None:
            self._checked(shot, self._checking)
        elif self._lookout is not None and self._lookout.probing is not None:
            self._probed(shot, self._lookout)
        elif self._soft is not None:
            self._rise(shot, self._soft)
        else:
            self._consider(shot)
        self.number += 1

    def _checked(self, shot: Shot, check: Check) -> None:
        """Take a shot of the check of a known drive; go on with it, learn from it, or start as without it."""
        found = check.take(shot.response)
        fields = {"entry": check.known.name, **{key: tidy(value) for key, value in vars(found).items()}}
        if not found.accepted:
            self._checking, self.lines = None, self._first_drive()
            self.decisions.append(Decision("library_refused", fields))
        elif check.over:
            self._checking = None
            self.daring.updates = sum(self.law.gains.stages) if found.worst_db <= 0 else 0  # no haste where it is met
            self.decisions.append(Decision("library_accepted", fields))
            self._learn(shot)
        else:
            self.lines = check.drive

    def _first_drive(self) -> np.ndarray:
        """Return the drive to begin with, (lines, inputs), V s, where none is known."""
        if self._rising is None:
            return self.law.start.copy()
        self._soft = SoftStart(self.law, self._rising, self._objective)
        return self._soft.level * self.law.start

    def _rise(self, shot: Shot, soft: SoftStart) -> None:
        """Learn from a shot at reduced level, and go on to the next level where what it emits allows."""
        self.belief.follow(shot)
        error = soft.level * self.law.reference - shot.response
        learned = self._improved(shot, error, 1.0)
        noise = (np.abs(self.belief.inverse) ** 2 @ shot.noise[..., None])[..., 0]
        self.lines, risen = soft.onward(shot, error, learned, noise)
        if risen is not None:
            self.decisions.append(risen)
            self.daring.promise_nothing()
        if soft.has_fallen:
            self.belief = Belief(self.law, self._parts)
        if soft.over:
            self._soft = None

    def _consider(self, shot: Shot) -> None:
        """Learn from a shot, unless a band diverges."""
        self.belief.follow(shot)
        if self._lookout is not None and self.daring.updates:
            seen = self._lookout.look(shot, self.law.reference - shot.response, self.daring.computed_bound, self.belief)
            self.decisions += seen.decisions
            if seen.frozen is not None:
                self.daring.freeze(seen.frozen)
                self._forget()
            if seen.drive is not None:
                self.lines = seen.drive
                return
        self._learn(shot)

    def _probed(self, shot: Shot, lookout: Lookout) -> None:
        """Take a shot of a reidentification; after the last one go on from where it began."""
        done = lookout.take(shot, self.belief, self.daring.nominal)
        if done is None:
            assert lookout.probing is not None
            self.lines = lookout.probing
            return
        base, gained = done
        self.decisions.append(gained)
        self._forget()
        self._learn(base)

    def _learn(self, shot: Shot) -> None:
        """Make the next drive from a shot."""
        daring, error = self.daring, self.law.reference - shot.response
        learned, expected = daring.is_open > 0, daring.expected
        self.lines = self._improved(shot, error, self._rollback.pace if self._rollback else 1.0)
        back = self._rollback and self._rollback.judged(self.number, shot.drive, error[learned], expected)
        if back:
            self.lines = back.lines
            self.decisions.append(Decision("rollback", {"to_shot": back.shot, "error_db": tidy(back.growth_db)}))
        daring.updates += 1

    def _improved(self, shot: Shot, error: np.ndarray, pace: float) -> np.ndarray:
        """Return the drive that takes of the error (lines, outputs) of a shot what is dared; keep the shot."""
        self.daring.choose(self.belief, shot, error, pace)
        lines = self._law.next(self.belief, Heard(shot.drive, error, self.daring.gain, self.daring.is_open))
        self.belief.keep(shot)
        return lines

    def _forget(self) -> None:
        """Let no earlier shot be gone back to: the vibrator, or what is learned of it, is another one since."""
        if self._rollback is not None:
            self._rollback.forget()


_NOTHING = {"model": False, "doubt": 0.0, "cautious": False, "rollback": False}
"""Parts of [adaptation] without which it is the thesis' law."""

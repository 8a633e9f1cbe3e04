"""The procedure that learns: a run shot by shot, which can pause between two shots and take up new settings there."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rigkit import config as rig_file
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.run_origin import take_over
from rigkit.service.paths import confined, run_path
from rigkit.service.reload import Change, Reach, taken
from rigkit.service.rig import Desk
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.daemon.live_spectrum import LiveSpectrum
from vibractl.daemon.options import RunOptions
from vibractl.daemon.panels import Panels
from vibractl.quality import Marks
from vibractl.reference import is_file
from vibractl.report import run_report
from vibractl.run_setup import create, refuse_other_wiring, require_room, resumed_setup, shot_files
from vibractl.session import Session
from vibractl.supervision import Supervision

_TOLD = ("started", "stopped", "finished", "failed")
"""Events of a run folder that the daemon tells by itself."""


class Running:
    """One run under the daemon.

    Parameters
    ----------
    config : RigConfig
    options : RunOptions
    desk : Desk
    supervision : Supervision

    Raises
    ------
    ValueError, OSError : settings, model and reference do not fit, or the disk has no room; no folder is made.
    """

    def __init__(self, config: RigConfig, options: RunOptions, desk: Desk, supervision: Supervision) -> None:
        self._desk, data = desk, Path(config.daemon.data)
        self.worst_db: float | None = None
        """The worst line of the last shot over the limit, dB."""
        self.discarded = 0
        self._waiting: tuple[RigConfig, list[str]] | None = None
        desk.progress(0, options.shots or config.session.shots, "getting ready")
        path = run_path(config.daemon.data, options.run)
        if options.resume:
            self._folder = RunFolder.open(path)
        else:
            asked, accept = _asked(config, options, data), options.accept
            self._folder, made = create(path, asked, data / options.model, shots=options.shots, accept=accept)
        try:
            if options.resume:
                refuse_other_wiring(path, config, options.accept)
                made = resumed_setup(self._folder, options.accept)
                left = (options.shots or made.config.session.shots) - len(shot_files(path))
                require_room(path, made, max(left, 0))
            self._folder.listener = self._heard
            self._session = Session(self._folder, made, supervision, options.accept)
            for note in filter(None, self._session.note.splitlines()):
                desk.event("note", {"text": note})
        except BaseException:
            self._folder.close()
            raise
        self.shots = options.shots or made.config.session.shots
        self._panels = Panels(desk, made)

    @property
    def line(self) -> Line | None:
        """The audio line, while it is open."""
        return self._session.line

    def take(self, new: RigConfig, change: Change) -> str:
        """Take what may change while a run goes on, from another thread; say when it holds."""
        now = [key for key, reach in change.keys.items() if reach is Reach.PARAMETERS]
        if "session.shots" in now:
            self.shots = new.session.shots
        devices = [key for key, reach in change.keys.items() if reach is Reach.DEVICES]
        if devices:
            earlier = [] if self._waiting is None else self._waiting[1]
            self._waiting = new, [*earlier, *devices]
        parts = ["now" * bool(now), "the audio stream is reopened after this shot" * bool(devices)]
        if change.keys.keys() - set(now) - set(devices):
            parts.append("the rest from the next run on, as this run's folder says what it was made with")
        return "; ".join(filter(None, parts))

    def run(self) -> None:
        """Learn until the last shot, and write the report; or until the desk says that it is to end."""
        with self._folder, LiveSpectrum(self._desk, self._session.config, lambda: self.line):
            try:
                self._learn()
            except BaseException:
                if self._session.untouched:
                    self._folder.withdraw()
                raise
            done = self._session.done
            if done:
                event = "finished" if done >= self.shots else "left"
                self._desk.event(event, {"run": self._folder.path.name, **self._session.summary()})
            if done >= self.shots:  # else nobody waits for it: `vibractl report` draws it at any time
                self._desk.progress(done, self.shots, "writing the report")
                run_report(self._folder.path)

    def _learn(self) -> None:
        session, desk = self._session, self._desk
        desk.progress(session.done, self.shots)
        while session.done < self.shots and not desk.ending():
            self._take_waiting()
            desk.recording(True)
            try:
                session.run(self.shots, self._tell, self._pausing)
            finally:
                desk.recording(False)
            if desk.held():
                desk.event("held", {"shot": session.done})
            desk.wait_while_held()

    def _pausing(self) -> bool:
        desk = self._desk
        return desk.ending() or desk.held() or self._waiting is not None or self._session.done >= self.shots

    def _tell(self, shot: int, marks: Marks) -> None:
        learner = self._session.learner
        self.worst_db = float(marks.worst_line_db.max())
        self._desk.progress(shot + 1, self.shots, self._session.said_of(marks))
        self._desk.event("shot", {"shot": shot, "worst_line_db": self.worst_db, "objective": marks.reason})
        heard = learner.far_field if self._session.judged.is_far else learner.response[: learner.shot.total]
        self._panels.draw(shot, marks, heard, learner.algorithm)

    def _heard(self, event: str, fields: Mapping[str, Any]) -> None:
        self.discarded += event == "discarded"
        if event not in _TOLD:
            self._desk.event(event, fields)

    def _take_waiting(self) -> None:
        """Put the settings that need the line opened again in force, and keep them with the run."""
        waiting, self._waiting = self._waiting, None
        if waiting is None:
            return
        self._session.config = now = taken(self._session.config, *waiting)
        kept = taken(rig_file.load(self._folder.path / CONFIG, RigConfig, as_written=True), *waiting)
        self._folder.write(CONFIG, rig_file.dump(kept))
        take_over(self._folder, kept, waiting[1])
        self._folder.event("reloaded", {"settings": rig_file.dump(now.audio) + rig_file.dump(now.limits)})


def _asked(config: RigConfig, options: RunOptions, data: Path) -> RigConfig:
    """Return the settings with what the options lay over them."""
    reference, watch = config.reference, config.watch
    if options.reference:
        signal = options.reference
        if is_file(signal):
            signal = str(confined(data, signal))
        reference = reference.model_copy(update={"signal": signal})
    if options.watch:
        watch = watch.model_copy(update={"on": True})
    return config.model_copy(update={"reference": reference, "watch": watch})

"""The vibrator's calibration as the daemon begins it: the same as `calibrate vibrator`, told to a desk."""

from pathlib import Path

from calibration.experiment import RawFolder, refuse_to_emit
from calibration.output import Wish, output
from calibration.sweep_report import sweep_report
from calibration.vibrator import KEPT, KIND, LiveLine, calibrate, refuse_unfit, require_room
from rigkit.progress import told_to
from rigkit.service.rig import Desk
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.daemon.options import CalibrationOptions
from vibractl.model_file import write_model
from vibractl.supervision import Supervision


class CalibrationProcedure:
    """One calibration under the daemon; one that was stopped goes on from what it had recorded.

    Parameters
    ----------
    config : RigConfig
    options : CalibrationOptions
    desk : Desk
    supervision : Supervision

    Raises
    ------
    ValueError : it could not end in a model, or the name of its model is taken, or unfinished with other settings.
    DiskFault : there is no room for it.
    """

    def __init__(self, config: RigConfig, options: CalibrationOptions, desk: Desk, supervision: Supervision) -> None:
        out = Path(config.daemon.data) / options.model
        wish = Wish(options.again, options.recompute, options.accept)
        self._writes = output(out, KIND, config, wish, [out.with_suffix(".html")], KEPT)
        self._config, self._out, self._desk, self._supervision = self._writes.config, out, desk, supervision
        self._raw = RawFolder(self._writes.raw)
        if not self._writes.is_recomputed:
            refuse_unfit(self._config)
            require_room(self._config, self._raw)
        self._live: LiveLine | None = None

    @property
    def made(self) -> bool:
        """Whether it is to end."""
        return self._desk.ending()

    @property
    def line(self) -> Line | None:
        """The audio line, while it is open."""
        return None if self._live is None else self._live.line

    def run(self) -> None:
        """Measure and write the model and its report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        """
        config, out, writes = self._config, self._out, self._writes
        for note in writes.notes:
            self._desk.event("note", {"text": note})
        self._desk.recording(True)
        with writes.begun(), self._raw as raw:
            with told_to(self._desk.progress), LiveLine(config, raw, self, self._supervision) as self._live:
                emit = refuse_to_emit if writes.is_recomputed else self._live.emit
                found = calibrate(config, raw, emit, writes.provenance)
            self._desk.recording(False)
            write_model(out, found.matrix.described(seconds=f"{found.seconds:.1f}"), found.far)
            writes.finish()
        sweep_report(found, config).write(out.with_suffix(".html"))
        self._desk.event("calibrated", {"model": out.name, "lines": len(found.matrix.frequency)})

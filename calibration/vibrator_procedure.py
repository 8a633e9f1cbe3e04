"""The vibrator's calibration as the daemon begins it: the same as `calibrate vibrator`, told to a desk."""

from pathlib import Path

from calibration.experiment import RawFolder
from calibration.raw_folder import raw_folder
from calibration.sweep_report import sweep_report
from calibration.vibrator import LiveLine, calibrate, refuse_unfit, require_room
from rigkit.progress import told_to
from rigkit.service.rig import Desk
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.model_file import write_model
from vibractl.supervision import Supervision


class CalibrationProcedure:
    """One calibration under the daemon; one that was stopped goes on from what it had recorded.

    Parameters
    ----------
    config : RigConfig
    out : Path
        Model file to write; recordings and report go beside it.
    desk : Desk
    supervision : Supervision

    Raises
    ------
    ValueError : it could not end in a model, or `out` is something else's.
    DiskFault : there is no room for it.
    """

    def __init__(self, config: RigConfig, out: Path, desk: Desk, supervision: Supervision) -> None:
        refuse_unfit(config)
        self._config, self._out, self._desk, self._supervision = config, out, desk, supervision
        self._raw = RawFolder(raw_folder(out))
        require_room(config, self._raw)
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
        config, out = self._config, self._out
        self._desk.recording(True)
        with self._raw as raw:
            with told_to(self._desk.progress), LiveLine(config, raw, self, self._supervision) as self._live:
                found = calibrate(config, raw, self._live.emit)
            self._desk.recording(False)
            write_model(out, found.matrix.described(seconds=f"{found.seconds:.1f}"), found.far)
        sweep_report(found, config).write(out.with_suffix(".html"))
        self._desk.event("calibrated", {"model": out.name, "lines": len(found.matrix.frequency)})

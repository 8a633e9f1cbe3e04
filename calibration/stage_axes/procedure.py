"""The stage's calibration as the daemon begins it: the same as `calibrate stage`, told to a desk."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from calibration.experiment import RawFolder
from calibration.output import Wish, output
from calibration.stage_axes.bench import Bench, ExcitedAxis, RecordedBench
from calibration.stage_axes.calibration import AxisCalibration, calibrate_axes
from calibration.stage_axes.experiment import KEPT, KIND, require_room
from calibration.stage_axes.files import ALL, axes_of, model_file, results, write
from calibration.stage_axes.live_bench import LiveBench
from calibration.stage_axes.report import (
    INNER_HEAD,
    MODEL_HEAD,
    OUTER_HEAD,
    inner_row,
    model_rows,
    outer_row,
    without_loop,
)
from calibration.stage_axes.rig import calibrated_rig
from rigkit import config as rig_file
from rigkit.progress import told_to
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Curves, Gauge, Table, Trace
from stagectl.config import StageConfig
from stagectl.daemon.gauges import driven, motion
from stagectl.daemon.options import CalibrationOptions
from stagectl.link.stage_link import StageLink
from stagectl.stage.piezo_pid import Pid

OUT = "stage.h5"
"""In the data folder: the models are stage-x.h5 and so on, and stage.toml is the rig file that belongs to them."""
POINTS = 400
"""At which a response is drawn."""


class StageProcedure:
    """One calibration of the stage under the daemon; one that was stopped goes on from what it had recorded.

    Parameters
    ----------
    config : StageConfig
    options : CalibrationOptions
    desk : Desk
    link : StageLink or None
        Of a live stage, open.

    Raises
    ------
    ValueError : an axis that the stage has not, or files that are something else's.
    """

    def __init__(self, config: StageConfig, options: CalibrationOptions, desk: Desk, link: StageLink | None) -> None:
        self._out = Path(config.daemon.data) / OUT
        if options.again and options.axis != ALL:
            raise ValueError(f"axis is {options.axis!r}, must be {ALL} where again is true: the axes share recordings")
        wish = Wish(options.again, options.recompute, options.accept)
        made = results(config, ALL, self._out)
        self._writes = output(self._out, KIND, config, wish, made, KEPT, self._is_whole(config, options.axis))
        self._config, self._options, self._desk, self._link = self._writes.config, options, desk, link
        self._axes = axes_of(config, options.axis)
        self._raw = RawFolder(self._writes.raw)
        if not options.recompute:
            require_room(config, len(self._axes), self._raw)
        self._found: list[AxisCalibration] = []
        self._stopped = False
        self._position, self._voltage = np.full((2, len(config.stage.axes)), np.nan)
        self._voltage.fill(config.limits.rest_voltage)

    def stop(self) -> None:
        """Take the stage to rest, from any thread."""
        self._stopped = True

    def gauges(self) -> Iterator[Gauge]:
        """Give where a simulated stage is, and what drives it; of a live one the link gives that."""
        if self._link is None:
            yield from motion(self._config, self._position, self._voltage)
            yield from driven(self._config, self._voltage)

    def run(self) -> StageConfig:
        """Measure, write the models and their reports, and return the rig file with what was chosen.

        Raises
        ------
        Stopped : the desk said that it is to end.
        ExcitationError, LinkError : something went wrong; the stage has gone to rest.
        """
        config, about = self._config, self._writes.provenance
        for note in self._writes.notes:
            self._desk.event("note", {"text": note})
        self._desk.recording(True)
        try:
            with self._writes.begun(), self._raw as raw, told_to(self._progress):
                for axis in self._axes:
                    self._found += calibrate_axes(config, [axis], raw, None, self._options.method, self._bench, about)
                    self._show()
                self._desk.recording(False)
                self._desk.progress(len(self._axes), len(self._axes), "writing models and reports")
                write(self._found, self._out, True, config, self._text())
                self._writes.finish()
        finally:
            self._desk.recording(False)
        lacking = without_loop(self._found)
        told = {"models": [each.axis for each in self._found], "rig_file": str(self._out.with_suffix(".toml"))}
        self._desk.event("calibrated", told | ({"without_loop": lacking} if lacking else {}))
        return calibrated_rig(config, self._found)

    def _is_whole(self, config: StageConfig, axis: str) -> bool:
        """Whether all that is asked for has a model: axes may be calibrated one by one."""
        return all(model_file(self._out, config.stage.axes[each], True).exists() for each in axes_of(config, axis))

    def _text(self) -> str:
        """Return the rig file that an earlier calibration has left, which a person may have edited; or the daemon's."""
        chosen = self._out.with_suffix(".toml")
        return chosen.read_text(encoding="utf-8") if chosen.is_file() else rig_file.dump(self._config)

    def _bench(self, axis: int, loop: Pid | None) -> ExcitedAxis:
        if self._writes.is_recomputed:
            return RecordedBench(self._config, axis, loop)
        if self._link is None:
            return Bench(self._config, axis, loop, self._ending, self._see)
        return LiveBench(self._config, axis, loop, self._link, self._ending, self._say)

    def _see(self, position: np.ndarray, voltage: np.ndarray) -> None:
        self._position[:] = position
        self._voltage[:] = voltage

    def _ending(self) -> bool:
        return self._stopped or self._desk.ending()

    def _say(self, text: str) -> None:
        self._desk.event("repeated", {"told": text})

    def _progress(self, done: float, total: float, note: str) -> None:
        """Tell how many axes are done; the excitations of an axis are told in words."""
        self._desk.progress(len(self._found), len(self._axes), f"{note}: {done:.0f} of {total:.0f} s")

    def _show(self) -> None:
        """Draw what has been found of all axes so far."""
        found, desk = self._found, self._desk
        desk.show("models", Table("Models", MODEL_HEAD, tuple(row for each in found for row in model_rows(each))))
        desk.show("inner", Table("Inner loops", INNER_HEAD, tuple(map(inner_row, found))))
        desk.show("outer", Table("Outer loops", OUTER_HEAD, tuple(map(outer_row, found))))
        low, high = self._config.characterisation.band
        frequency = np.geomspace(low, high, POINTS)
        traces = tuple(
            Trace(each.axis, frequency, np.abs(each.closed.one.model.frequency_response(frequency)[:, 0, 0]))
            for each in found
        )
        axes = Axis("frequency", "Hz", "log"), Axis("gain", "m/m", "log")
        desk.show("response", Curves("From the inner loop's reference to the position", *axes, traces))

"""The vibrator as the daemon's rig."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Protocol

from rigkit import config as rig_file
from rigkit.code_name import refuse_absent, resolve
from rigkit.disk_space import refuse_full
from rigkit.faults import FaultTable
from rigkit.named_code import KnownCode
from rigkit.run_folder import CONFIG
from rigkit.service.filed_rig import FiledRig
from rigkit.service.not_begun import making
from rigkit.service.paths import run_path
from rigkit.service.reload import Change, Reach
from rigkit.service.rig import Desk, Procedure
from rigkit.service.show import Gauge
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.daemon.options import CalibrationOptions, RunOptions
from vibractl.daemon.running import Running
from vibractl.proof import SLIP
from vibractl.supervision import Supervision, input_names

CALIBRATION = "calibration.vibrator_procedure:CalibrationProcedure"
"""Found when it is asked for: calibration stands above this package."""

REACHES = {
    "session.shots": Reach.PARAMETERS,
    "limits": Reach.DEVICES,
    "audio": Reach.DEVICES,
    "simulator": Reach.DEVICES,
    "simulator.plant": Reach.GRAPH,
    "simulator.options": Reach.GRAPH,
    "audio.rate": Reach.GRAPH,
    "audio.output_full_scale": Reach.GRAPH,
    "audio.input_full_scale": Reach.GRAPH,
    "audio.far_field_full_scale": Reach.GRAPH,
    "audio.alignment": Reach.GRAPH,
    "audio.drive_channels": Reach.GRAPH,
    "audio.response_channels": Reach.GRAPH,
    "audio.far_field_channels": Reach.GRAPH,
    "limits.ramp": Reach.GRAPH,
}
"""The learner knows rate, channels and ramp, and what is recorded stands for what the scales say: with others it is
another run."""


class _UnderWay(Protocol):
    """A procedure while it runs."""

    @property
    def line(self) -> Line | None:
        """The audio line, while it is open."""


class _Whole(_UnderWay, Protocol):
    """One that has yet to run."""

    def run(self) -> None:
        """Run it to its end."""


class Vibrator(FiledRig[RigConfig]):
    """A marine vibrator under the daemon.

    Parameters
    ----------
    load : callable() -> RigConfig
        Reads the rig file, with the settings laid over it; again at each reload.
    """

    program = "vibractl"
    reaches = REACHES

    def __init__(self, load: Callable[[], RigConfig]) -> None:
        super().__init__(load)
        self._known = KnownCode(self.config)
        self.name = self.config.rig.name
        self._under_way: _UnderWay | None = None
        self.faults = FaultTable(input_names(self.config.audio)) if self.config.daemon.faults else None
        aborted = "This shot is played to its end and recorded, then the drive is silent and the rig stays armed."
        paused = "This shot is finished and learned from; then the drive is silent until the run is resumed."
        self.procedures: Sequence[Procedure] = (
            Procedure("run", "Learning run", "run", "shots", True, paused, aborted, RunOptions, self._run),
            Procedure(
                "calibrate",
                "Calibration",
                "calibrate",
                "records",
                False,
                "",
                aborted,
                CalibrationOptions,
                self._calibrate,
            ),
        )

    def gauges(self) -> Sequence[Gauge]:
        """Return levels against limits, how the audio keeps up, and room on the disk."""
        under_way = self._under_way
        line = None if under_way is None else under_way.line
        found: list[Gauge] = []
        if line is not None:
            found += self._levels(line)
        elif under_way is not None:  # it is closed, between two shots: the card is given nothing
            found += (self._drive_peak(side, 0.0) for side, _ in enumerate(self.config.audio.drive_channels, start=1))
        if isinstance(under_way, Running):
            found.append(Gauge("worst_line", "Worst bin over the objective", under_way.worst_db, "dB", high=0.0))
            found.append(Gauge("discarded", "Recordings discarded", under_way.discarded, "1"))
        return [*found, self.room()]

    def arm(self) -> None:
        """See that there is what opens an audio interface, and room to record.

        It is imported in the audio process alone: PortAudio aborts a program whose audio server has died, at its end.
        """
        refuse_full(Path(self.config.daemon.data))
        refuse_absent(self.config.audio.stream)

    def disarm(self) -> None:
        """Nothing: the audio line is open while a procedure runs and no longer."""

    def stop(self) -> None:
        """Ramp down what is played."""
        under_way = self._under_way
        line = None if under_way is None else under_way.line
        if line is not None:
            line.stop()

    def acknowledge(self, who: str) -> None:
        """Nothing: a guard that has latched went with its audio process, and a new one is closed."""

    def close(self) -> None:
        """Nothing is open."""

    def _check(self, new: RigConfig) -> None:
        self._known.refuse_other(new)

    def _take(self, new: RigConfig, change: Change) -> str:
        under_way, held = self._under_way, super()._take(new, change)
        if self.faults is not None and self.faults.names != input_names(new.audio):
            self.faults = FaultTable(input_names(new.audio))
        return under_way.take(new, change) if change.keys and isinstance(under_way, Running) else held

    def _drive_peak(self, side: int, peak: float) -> Gauge:
        most = self.config.limits.peak
        return Gauge(f"drive_peak_{side}", f"Drive {side}, peak", peak, "V", high=most, is_output=True)

    def _levels(self, line: Line) -> Iterator[Gauge]:
        limits = self.config.limits
        now = line.levels
        for side, (peak, rms) in enumerate(zip(now.drive_peak, now.drive_rms, strict=True), start=1):
            yield self._drive_peak(side, float(peak))
            yield Gauge(f"drive_rms_{side}", f"Drive {side}, rms", float(rms), "V", high=limits.rms)
        full = self.config.audio.input_full_scale
        for side, peak in enumerate(now.response_peak, start=1):
            yield Gauge(f"response_peak_{side}", f"Response {side}, peak", float(peak), "m/s^2", high=full)
        yield Gauge("alignment", "Alignment, last shot", line.residual, "samples", -SLIP, SLIP)
        yield Gauge("xruns", "Callbacks with lost data, last shot", now.xruns, "1", high=0)
        yield Gauge("late", "Late callbacks, last shot", now.late, "1")
        if self.config.audio.relay.bus:
            yield Gauge("relay_beats", "Heartbeats to the relay", now.beats, "1")

    def _run(self, desk: Desk, options: RunOptions) -> None:
        with making(desk):
            if options.resume:
                kept = run_path(self.config.daemon.data, options.run) / CONFIG
                self._known.refuse_other(rig_file.load(kept, RigConfig, as_written=True))
            running = Running(self.config, options, desk, self._supervision())
        self._follow(running)

    def _calibrate(self, desk: Desk, options: CalibrationOptions) -> None:
        with making(desk):
            calibration = resolve(CALIBRATION)(self.config, options, desk, self._supervision())
        self._follow(calibration)

    def _supervision(self) -> Supervision:
        return Supervision(self.config.daemon.mute_after, self.faults)

    def _follow(self, procedure: _Whole) -> None:
        self._under_way = procedure
        try:
            procedure.run()
        finally:
            self._under_way = None

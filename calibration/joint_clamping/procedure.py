"""The joints' calibration as the daemon begins it: the same as `calibrate joints` in one pose, told to a desk."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from calibration.guided_arm import arm_with_tool
from calibration.joint_clamping.aside import Here
from calibration.joint_clamping.command import WAY_OF, joint_numbers
from calibration.joint_clamping.joints_file import write_joints
from calibration.joint_clamping.live_map import LiveMap
from calibration.joint_clamping.maps_page import nothing
from calibration.joint_clamping.measurement import ClampRun
from calibration.joint_clamping.recorded_joints import missing, require_room
from calibration.joint_clamping.report import HEAD, joints_report, rows
from calibration.joint_clamping.results import RAW, Clamped, of_recording
from calibration.joint_clamping.session import KEPT, KIND, beside, measure
from calibration.joint_clamping.session import Desk as Conducted
from calibration.names import raw_folder
from calibration.output import Wish, output
from calibration.raw_run import raw_run
from rigkit.experiment.runner import Conduct
from rigkit.experiment.strips import PERIOD
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge, Table
from stagectl.daemon.cell.options import JointsOptions
from stagectl.daemon.cell_gauges import Motion, timed
from stagectl.daemon.conductor import Conductor
from stagectl.robot.clamp_config import clamp_procedure
from stagectl.robot.config import CellConfig

SOURCES = {"reference": "search.reference", "torque": "robot.torque"}


class JointsProcedure:
    """One calibration of joints under the daemon; one that was stopped goes on with the joints that are missing.

    Parameters
    ----------
    config : CellConfig
    options : JointsOptions
    desk : Desk

    Raises
    ------
    ValueError : a live one is to be paced, joints that the arm has not, limits that do not fit to it, or a model
        that is something else's.
    """

    def __init__(self, config: CellConfig, options: JointsOptions, desk: Desk) -> None:
        options.refuse_live("clamping.live", config.clamping.live)
        self._conductor, self._desk = Conductor(desk, SOURCES, options.paced), desk
        self._out = Path(config.daemon.data) / options.model
        wish = Wish(options.again, options.recompute, options.accept)
        self._folder = raw_folder(self._out)
        self._joints = joint_numbers(options.joints, arm_with_tool(config).joints)
        is_whole = not missing(self._folder, self._joints)
        made = [self._out.with_suffix(".html")]
        self._writes = output(self._out, KIND, config, wish, made, KEPT, is_whole)
        config = self._writes.config
        self._cell, self._options = config, options
        self._arm = arm_with_tool(config)
        self._pose = clamp_procedure(config.clamping, self._arm, self._joints).pose
        left = self._joints if options.again else missing(self._folder, self._joints)
        if left and options.recompute:
            raise ValueError(f"{self._folder}/ has no recording of joint {left[0] + 1}, and nothing is to be measured")
        self._steps = len(clamp_procedure(config.clamping, self._arm, left).steps()) if left else 0
        require_room(self._folder, len(left))
        self._motion = Motion(config, idle=None if config.clamping.live else 0.0)
        self._run: ClampRun | None = None

    def stop(self) -> None:
        """Hold the arm where it is: soft servo and clamp stay."""
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return where the tool is, how fast references move, and each joint's torque against its limit."""
        watch, limits = self._conductor.watch, self._cell.clamping.torque
        torque = watch.newest("torque")
        told = [] if torque is None else zip(torque.tolist(), limits, strict=True)
        pushed = [
            Gauge(f"torque_{joint}", f"Joint {joint}, torque", value, "N m", -most, most)
            for joint, (value, most) in enumerate(told, start=1)
        ]
        return [*pushed, *self._motion.gauges(watch), *timed(watch)]

    def run(self) -> None:
        """Measure, extract the models, write them and their report.

        Raises
        ------
        Stopped : the desk said that it is to end; the arm holds.
        PartEnded, LinkError : something went wrong; the arm holds.
        """
        desk, cell = self._desk, self._cell
        desk.progress(0, self._steps, "getting ready")
        for note in self._writes.notes:
            desk.event("note", {"text": note})
        with (
            self._writes.begun(),
            self._recording(),
            beside(cell, nothing) as work,
            Regularly(partial(self._draw, LiveMap(desk, work)), PERIOD),
            raw_run(self._folder, cell) as folder,
        ):
            recorded, way = measure(cell, self._joints, folder, self._conducted())
        desk.progress(self._steps, self._steps, "extracting the models")
        clamped = Clamped(self._arm, self._pose, cell.clamping.environment)
        chosen = WAY_OF[self._options.compensate]
        results = [of_recording(recorded[joint], way, joint, clamped, chosen) for joint in self._joints]
        source = f"{self._folder.name}/"
        write_joints(self._out, results, {"recording": source, **self._writes.provenance})
        self._writes.finish()
        joints_report(results, None, source).write(self._out.with_suffix(".html"))
        maps = LiveMap(desk, Here())
        for each in results:
            cycles = f"{each.models[RAW].cycles:g} cycles"
            maps.show(each.joint, cycles, each.map.angle, each.map.torque, each.models[RAW])
        desk.show("joints", Table("Joints", HEAD, tuple(rows(results))))
        said = {f"joint_{each.joint + 1}": each.best[1].backlash_said for each in results}
        desk.event("calibrated", {"model": self._out.name, **said})

    def _conducted(self) -> Conducted:
        watch = self._conductor.watch
        return Conducted(self._told, Conduct(self._conductor.ending, watch, watch.look), begun=self._begun)

    @contextmanager
    def _recording(self) -> Iterator[None]:
        self._desk.recording(True)
        try:
            yield
        finally:
            self._desk.recording(False)
            self._run = None
            self._conductor.watch.forget()

    def _begun(self, run: ClampRun) -> None:
        self._run = run

    def _told(self, text: str) -> None:
        time, _, words = text.partition(" s  ")
        self._desk.event("step", {"told": words or text, "seconds": time.strip()})

    def _draw(self, maps: LiveMap) -> None:
        run = self._run
        if run is not None:
            step = min(run.search.step, self._steps - 1)
            self._desk.progress(step, self._steps, run.search.steps[step].words)
            maps.draw(run.growing())

"""The recording of a run that may be killed at any moment: a WAV that grows, in the rig file's format at its end."""

from collections.abc import Sequence

from ctlblocks import recording
from ctlblocks.recording import RecordingError
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.stream_recorder import StreamRecorder
from rigkit.stream_writer import Stream
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import channels_of, ports_of
from stagectl.experiments.piezo.lasers import reads_laser

RECORDING, UNCOMPENSATED = "recording", "uncompensated"
"""Names of a run's recordings, less the suffix."""
RECORDED_LIVE = ("reference", "position", "extension", "voltage")
"""What is recorded of a live run; `recorded_live` says whether there is more."""


def recorded_live(config: StageConfig) -> tuple[str, ...]:
    """Return what is recorded of a live run: what lasers see as well, where they are read.

    Parameters
    ----------
    config : StageConfig
    """
    return (*RECORDED_LIVE, "absolute") if reads_laser(config) else RECORDED_LIVE


def recordings_of(config: StageConfig) -> list[str]:
    """Return the names of a run's recordings, in the order in which they are made.

    Parameters
    ----------
    config : StageConfig
    """
    return [UNCOMPENSATED] * config.session.compare + [RECORDING]


def recorder(
    folder: RunFolder, config: StageConfig, signals: Sequence[str], name: str = RECORDING, *, has_thread: bool = True
) -> StreamRecorder:
    """Return the recorder of a run's signals.

    Parameters
    ----------
    folder : RunFolder
    config : StageConfig
    signals : sequence of str
        Their names, each one wide an axis.
    name : str
        Of the recording.
    has_thread : bool
        As of `StreamRecorder`.
    """
    axes = config.stage.axes
    about = {"rig": config.rig.name, "date": now(), "software": software()}
    stream = Stream(folder.path / f"{name}.wav", ports_of(signals, axes), channels_of(signals, axes), about)
    return StreamRecorder(stream, folder.event, has_thread=has_thread)


def convert(folder: RunFolder, config: StageConfig, made: StreamRecorder) -> None:
    """Convert what was recorded to the format that the rig file asks for."""
    if config.session.recording != "csv":
        return
    for path in made.files:
        try:
            recording.write(path.with_suffix(".csv"), recording.read(path))
        except RecordingError as fault:
            folder.event("kept_as_wav", {"recording": path.name, "text": str(fault)})
        else:
            path.unlink()

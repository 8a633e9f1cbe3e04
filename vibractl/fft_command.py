"""The command `vibractl plan-ffts`."""

import sys
import time

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, words, write_json
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from vibractl.config import RigConfig
from vibractl.fft_measurement import measured
from vibractl.fft_plans import Plans, user_wisdom
from vibractl.fft_transform import library_of
from vibractl.reference_option import ReferenceOption
from vibractl.setup import reference_of, transforms


def plan_command(
    config: ConfigOption = None,
    reference: ReferenceOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Measure the FFT plans of a reference's length for later runs; without them a run estimates its plans at once.

    It takes seconds to minutes, and may save some milliseconds a shot.  Each plan is stored for this user as soon as
    it is measured: after a stop the same command continues there.

    Example: `vibractl plan-ffts --config rig.toml --reference chirp:40:90:60`
    """
    rig = rig_file.load(config, RigConfig, laid_over(settings, {"reference.signal": reference}))
    if library_of(rig.spectrum.backend) == "scipy":
        raise ValueError("spectrum.backend is scipy, or pyfftw is not installed: SciPy's FFTs have no plans to measure")
    sizes = transforms(rig, len(reference_of(rig).signal))
    path, before = user_wisdom(), Plans.of_user()
    if before.note:
        sys.stderr.write(f"{before.note}\n")
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic.write(path, before.wisdom)  # a disk that refuses does so now
    work, began = [frames * width for frames, width in sizes], time.monotonic()
    done = 0
    with stoppable() as stop, progress("measuring FFT plans", sum(work)) as meter:
        for found in measured(before.wisdom, sizes):
            if found is not None:
                atomic.write(path, found)
                done += 1
            elif stop.made:
                break
            size = sizes[min(done, len(sizes) - 1)]
            note = f"{done} of {len(sizes)} done, {size.frames} samples x {size.width} channels"
            meter.show(sum(work[:done]), f"{note}, {time.monotonic() - began:.0f} s")
    if done < len(sizes):
        raise Stopped(f"{done} of {len(sizes)} FFT plans are stored in {path}; the same command continues there")
    print(f"{done} FFT plans are stored in {path}; runs use them from now on", file=words(json))  # noqa: T201
    write_json(json, {"file": str(path), "plans": [{"samples": size.frames, "channels": size.width} for size in sizes]})

"""Give a daemon twenty clients, one of which reads nothing, and look at who gets how much and at the audio.

`python -m benchmarks.daemon_clients [SECONDS]`
"""

import asyncio
import itertools
import multiprocessing
import os
import sys
import tempfile
import time
from multiprocessing.connection import Connection
from pathlib import Path

from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from rigkit.run_folder import read_quality
from rigkit.service.gate import STREAM
from tests.until import until
from tests.vibractl.daemon.killed import KilledDaemon, straight_daemon

CLIENTS = 20
SECONDS = 60.0


async def watch(uri: str, token: str, seconds: float, reads: bool) -> tuple[int, float]:
    """Watch for so long; return how many snapshots came, and after how many seconds the line was cut, or 0."""
    headers, begin, ticks = {"Authorization": f"Bearer {token}"}, time.monotonic(), 0
    options = {"additional_headers": headers, "subprotocols": [STREAM], "compression": None}
    async with connect(uri, **options) as socket:  # type: ignore[arg-type]
        try:
            while time.monotonic() - begin < seconds:
                text = await asyncio.wait_for(socket.recv(), seconds)
                ticks += 1
                if reads:
                    await socket.send(str(text)[len('{"tick": ') :].split(",")[0])
        except ConnectionClosed:
            return ticks, time.monotonic() - begin
    return ticks, 0.0


def crowd(address: str, token: str, seconds: float, told: Connection) -> None:
    """Be all the clients, in a process of its own."""

    async def all_of_them() -> list[tuple[int, float]]:
        uri = f"ws://{address}/api/stream"
        return await asyncio.gather(*(watch(uri, token, seconds, number > 0) for number in range(CLIENTS)))

    told.send(asyncio.run(all_of_them()))


def lateness(daemon: KilledDaemon, first: int, seconds: float) -> tuple[float, int, int]:
    """Let shots go by; return the late callbacks a shot, the shots, and the recordings discarded."""
    discarded = len(daemon.named("discarded"))
    end = time.monotonic() + seconds
    until(lambda: time.monotonic() > end, seconds + 60)
    last = daemon.done()
    rows = read_quality(Path(daemon.settings.data) / "runs" / "one")[first:last]
    return (
        sum(int(row["late"]) for row in rows) / max(len(rows), 1),
        len(rows),
        len(daemon.named("discarded")) - discarded,
    )


def footprint(pid: int) -> tuple[float, int]:
    """Return the memory of a process, MB, and its open files."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6, len(os.listdir(f"/proc/{pid}/fd"))


def main(seconds: float) -> None:
    """Measure, and print what became of the clients and of the audio."""
    with tempfile.TemporaryDirectory() as folder, straight_daemon(Path(folder)) as daemon:
        daemon.command("arm")
        daemon.command("begin", run="one", shots=1000)
        until(lambda: daemon.done() >= 2, 120)
        alone = lateness(daemon, daemon.done(), seconds)
        ours, theirs = multiprocessing.get_context("spawn").Pipe()
        arguments = (daemon.settings.address, daemon.tokens.view, seconds, theirs)
        process = multiprocessing.get_context("spawn").Process(target=crowd, args=arguments)
        with daemon.client() as client:
            begin = client.snapshot()
        processes = {"rig": daemon.process.pid, "web": daemon.web}
        before = {name: footprint(pid) for name, pid in processes.items()}
        process.start()
        watched = lateness(daemon, daemon.done(), seconds)
        found: list[tuple[int, float]] = ours.recv()
        process.join()
        with daemon.client() as client:
            end = client.snapshot()
        after = {name: footprint(pid) for name, pid in processes.items()}
    (stalled, *reading), ticks = found, 25.0 * seconds
    least = min(count for count, _ in reading)
    print(f"{CLIENTS} clients, {seconds:g} s: {least} to {max(count for count, _ in reading)} of {ticks:g} snapshots")
    print(f"  the one that does not read had {stalled[0]} and was cut off after {stalled[1]:.2f} s")
    made = end["tick"] - begin["tick"]
    print(
        f"  the rig's process made {made} snapshots meanwhile, {end['late_ticks'] - begin['late_ticks']} of them late"
    )
    for name, (late, shots, discarded) in (("alone", alone), ("watched", watched)):
        print(f"  {name}: {late:.2f} late callbacks a shot of 1.6 s, {shots} shots, {discarded} recordings discarded")
    for name in before:
        grown, files = after[name][0] - before[name][0], after[name][1] - before[name][1]
        print(f"  the {name} process has {after[name][0]:.0f} MB, {grown:+.1f} since; {files:+d} open files")


if __name__ == "__main__":
    main(float(next(itertools.islice(sys.argv, 1, None), SECONDS)))

"""The daemon as its processes: what stalls or dies, and what goes on."""

import json
import os
import select
import signal
import socket
import subprocess
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from rigkit.lock import holder
from rigkit.service.client import Client, DaemonError
from rigkit.service.stopping import LOCK
from tests.contract import monitoring
from tests.rigkit.service.served import answers, listener, served
from tests.until import EVER, until

LONG = {"steps": 100_000, "seconds": 0.02}


def test_a_person_takes_control_arms_begins_watches_and_stops(tmp_path: Path) -> None:
    with served(tmp_path) as daemon, daemon.client() as client:
        with client.control("Ada"):
            assert client.command("arm", "a test")["state"] == "ARMED"
            client.begin("demonstrate", **LONG)
            for number, shown in enumerate(client.watch()):
                if number > 20 and shown["procedure"]["done"] > 3:
                    break
            assert (shown["state"]["name"], shown["control"]["who"], shown["recording"]) == ("RUNNING", "Ada", True)
            assert client.panel("convergence")["traces"][0]["name"] == "error"
            with pytest.raises(DaemonError, match="cannot arm now: the rig is RUNNING") as refused:
                client.command("arm", "again")
            assert refused.value.status == 409
        with daemon.client() as another, pytest.raises(DaemonError, match="nobody has control"):
            another.command("abort")
        assert client.stop("Bob", "smoke")["state"] == "DISARMED"
        until(lambda: client.snapshot()["procedure"] is None)
        events = [(entry["event"], entry["who"]) for entry in client.events() if entry["event"] != "step"]
    assert events == [
        ("started", "daemon"),
        ("control", "Ada"),
        ("arm", "Ada"),
        ("run", "Ada"),
        ("control given back", "Ada"),
        ("stop", "Bob"),
        ("end", "demonstrate"),
    ]


def test_a_web_process_that_stalls_or_dies_does_not_hold_up_the_rig_and_comes_again(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        daemon.begin(**LONG)
        os.kill(daemon.web, signal.SIGSTOP)
        steps = len(daemon.named("step"))
        until(lambda: len(daemon.named("step")) > steps + 50)
        dead = daemon.web
        os.kill(dead, signal.SIGKILL)
        until(lambda: daemon.named("web process died"))
        steps = len(daemon.named("step"))
        until(lambda: answers(daemon))
        assert daemon.web != dead
        assert len(daemon.named("step")) > steps
        with daemon.client() as client:
            assert client.snapshot()["state"]["name"] == "RUNNING"


def test_a_stop_needs_no_web_process(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        daemon.begin(**LONG)
        os.kill(daemon.web, signal.SIGSTOP)
        process = holder(tmp_path / LOCK)
        assert process == daemon.process.pid
        os.kill(process, signal.SIGUSR1)
        until(lambda: daemon.named("end") and daemon.named("stop"))
        assert daemon.named("stop")[0] | {"number": 0, "time": ""} == {
            "number": 0,
            "time": "",
            "event": "stop",
            "who": "signal",
            "state": "DISARMED",
            "before": "RUNNING",
            "why": "SIGUSR1",
        }


def test_after_a_kill_the_rig_is_disarmed_and_the_log_is_whole(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        daemon.begin(**LONG)
        until(lambda: len(daemon.named("step")) > 5)
        web = os.pidfd_open(daemon.web)
        daemon.process.kill()
        daemon.process.wait()
        assert select.select([web], [], [], EVER)[0], "the web process outlived the rig's"
        os.close(web)
        before = len((tmp_path / "events.jsonl").read_text().splitlines())
    with served(tmp_path) as daemon:
        with daemon.client() as client:
            assert client.snapshot()["state"]["name"] == "DISARMED"
        events = daemon.events()
        assert len(events) > before - 1
        assert events[-1]["event"] == "started"


def test_ctrl_c_stops_the_procedure_and_ends_both_processes(tmp_path: Path) -> None:
    with served(tmp_path) as daemon:
        daemon.begin(**LONG)
        web = os.pidfd_open(daemon.web)
        os.kill(daemon.web, signal.SIGINT)  # as a terminal sends it to both
        daemon.process.send_signal(signal.SIGINT)
        assert daemon.process.wait(EVER) == 0
        os.close(web)
    last = [entry["event"] for entry in daemon.events()][-4:]
    assert "stop" in last
    assert last[-2:] == ["end", "ended"]


@pytest.mark.slow
def test_a_socket_in_the_file_system_is_its_owners_alone_and_goes_with_the_daemon(tmp_path: Path) -> None:
    path = tmp_path / "daemon.sock"
    with served(tmp_path, address=f"unix:{path}") as daemon:
        assert path.stat().st_mode & 0o777 == 0o600
        with daemon.client() as client:
            assert next(client.watch())["rig"] == "bench"
    assert not path.exists()


@pytest.mark.slow
def test_with_a_certificate_it_speaks_tls_and_nothing_else(tmp_path: Path) -> None:
    certificate, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    subject = ["-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1"]
    made = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    subprocess.run(
        [*made, "-days", "1", *subject, "-keyout", str(key), "-out", str(certificate)], check=True, capture_output=True
    )
    with served(tmp_path / "data", certificate=str(certificate), key=str(key)) as daemon:
        with daemon.client() as client:
            before = set(threading.enumerate())
            stream = client.watch()
            assert next(stream)["rig"] == "bench"
            assert set(threading.enumerate()) <= before, "TLS is read and written by one thread, or it loses requests"
            stream.close()
        with (
            Client(daemon.settings.address, daemon.tokens.view) as plain,
            pytest.raises(DaemonError, match="no answer"),
        ):
            plain.snapshot()


@dataclass(frozen=True)
class Life:
    """What one daemon told others from its beginning to its end: systemd, PlotJuggler and Prometheus."""

    systemd: frozenset[str]
    plotjuggler: bytes
    metrics: str


@pytest.fixture(scope="module")
def life(tmp_path_factory: pytest.TempPathFactory) -> Life:
    folder, told = tmp_path_factory.mktemp("life"), set()
    path = str(folder / "notify")
    with listener() as plotting, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(path)
        systemd.settimeout(30)
        where = "127.0.0.1:{1}".format(*plotting.getsockname())
        environment = {"NOTIFY_SOCKET": path, "WATCHDOG_USEC": "400000"}
        with served(folder / "data", environment, plotjuggler=where) as daemon:
            gauges = plotting.recv(10_000)
            headers = {"Authorization": f"Bearer {daemon.tokens.view}"}
            metrics = httpx.get(f"http://{daemon.settings.address}/metrics", headers=headers).text
            while not {"READY=1", "WATCHDOG=1\nSTATUS=DISARMED"} <= told:
                told.add(systemd.recv(1000).decode())
            assert "STOPPING=1" not in told
        while "STOPPING=1" not in told:
            told.add(systemd.recv(1000).decode())
    return Life(frozenset(told), gauges, metrics)


@pytest.mark.slow
def test_systemd_is_told_that_it_is_ready_lives_and_ends(life: Life) -> None:
    assert {"READY=1", "WATCHDOG=1\nSTATUS=DISARMED", "STOPPING=1"} <= life.systemd


def test_plotjuggler_gets_the_gauges_as_json(life: Life) -> None:
    told = json.loads(life.plotjuggler)
    assert told["timestamp"] > 1.7e9
    assert set(told["demo"]) == {"output", "travel", "force", "done"}


def test_prometheus_gets_state_gauges_and_limits(life: Life) -> None:
    samples = {
        (sample.name, sample.labels.get("state")): sample.value
        for family in text_string_to_metric_families(life.metrics)
        for sample in family.samples
    }
    assert samples["vibrostage_state", "DISARMED"] == 1
    assert samples["vibrostage_state", "RUNNING"] == 0
    assert samples["vibrostage_output_volts", None] == 0
    assert samples["vibrostage_travel_metres_high_limit", None] == 1.05e-6
    assert samples["vibrostage_ticks_total", None] > 0
    assert samples["vibrostage_output_on", None] == samples["vibrostage_journal_fault", None] == 0
    assert 0 <= time.time() - samples["vibrostage_snapshot_timestamp_seconds", None] < 60
    assert monitoring.missing(life.metrics, (monitoring.DAEMON,)) == {
        "vibrostage_disk_free_bytes",
        "vibrostage_disk_free_bytes_low_limit",
    }

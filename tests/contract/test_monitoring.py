"""The dashboard and the alert rules: what Grafana and Prometheus can read, of metrics that there are.

That there are, the tests of the rigs and of the daemon say, each for the rows that are its own.
"""

import shutil
import subprocess
from itertools import combinations
from typing import Any

import pytest

from rigkit.service.config import Daemon
from tests.contract import monitoring
from tests.contract.monitoring import DASHBOARD, RULES, SCRAPES, asked, named, read
from tests.contract.source_tree import ROOT

PROMTOOL = shutil.which("promtool") or ""
KINDS = {"row", "stat", "timeseries", "state-timeline", "bargauge"}
WIDTH = 24
"""Columns of Grafana's grid."""


@pytest.fixture(scope="module")
def panels() -> list[dict[str, Any]]:
    return list(read(DASHBOARD)["panels"])


def test_the_dashboard_is_one_that_grafana_takes(panels: list[dict[str, Any]]) -> None:
    """Its JSON model: https://grafana.com/docs/grafana/latest/dashboards/build-dashboards/view-dashboard-json-model/."""
    board = read(DASHBOARD)
    assert (board["uid"], board["title"], board["schemaVersion"]) == ("vibrostage", "Vibrostage", 39)
    variables = {each["name"] for each in board["templating"]["list"]}
    assert variables == {"source", "job"}
    assert len({panel["id"] for panel in panels}) == len(panels)
    assert all(panel["id"] > 0 and panel["title"] and panel["type"] in KINDS for panel in panels)
    for panel in (panel for panel in panels if panel["type"] != "row"):
        assert panel["datasource"] == {"type": "prometheus", "uid": "${source}"}
        letters = [target["refId"] for target in panel["targets"]]
        assert letters
        assert len(set(letters)) == len(letters)
        assert all('job=~"$job"' in target["expr"] for target in panel["targets"]), panel["title"]


def test_no_panel_lies_over_another(panels: list[dict[str, Any]]) -> None:
    for panel in panels:
        place = panel["gridPos"]
        assert min(place["x"], place["y"]) >= 0 < min(place["w"], place["h"])
        assert place["x"] + place["w"] <= WIDTH
    for one, other in combinations(panels, 2):
        a, b = one["gridPos"], other["gridPos"]
        apart = a["x"] + a["w"] <= b["x"] or b["x"] + b["w"] <= a["x"]
        below = a["y"] + a["h"] <= b["y"] or b["y"] + b["h"] <= a["y"]
        assert apart or below, (one["title"], other["title"])


def test_each_row_is_looked_after_by_a_test_of_what_gives_it() -> None:
    looked_after = {value for name, value in vars(monitoring).items() if name.isupper() and isinstance(value, str)}
    assert {row for row, _ in asked()} == looked_after
    assert all(name.lstrip("~").startswith(("vibrostage_", "up")) for _, text in asked() for name in named(text))


def test_rules_have_a_name_of_their_own_a_severity_and_a_sentence() -> None:
    rules = [rule for group in read(RULES)["groups"] for rule in group["rules"]]
    assert len({rule["alert"] for rule in rules}) == len(rules) > 10
    for rule in rules:
        assert set(rule) <= {"alert", "expr", "for", "labels", "annotations"}
        assert rule["labels"]["severity"] in ("critical", "warning", "info")
        assert rule["annotations"]["summary"]


def test_prometheus_is_sent_to_the_daemons_with_a_token_and_to_the_rules() -> None:
    held = read(SCRAPES)
    assert held["rule_files"] == [RULES.name]
    jobs = {job["job_name"]: job for job in held["scrape_configs"]}
    assert jobs.keys() == {"vibrator", "stage"}
    assert jobs["vibrator"]["static_configs"] == [{"targets": [Daemon().address]}]
    for name, job in jobs.items():
        assert job["authorization"] == {"type": "Bearer", "credentials_file": f"/etc/prometheus/{name}.token"}
    assert 'job=~"vibrator|stage"' in RULES.read_text()


@pytest.mark.skipif(not PROMTOOL, reason="no promtool here (apt-get install prometheus)")
@pytest.mark.parametrize("command", [["rules", RULES.name], ["config", "--syntax-only", SCRAPES.name]])
def test_prometheus_understands_every_line(command: list[str]) -> None:
    done = subprocess.run(
        [PROMTOOL, "check", *command], cwd=ROOT / "packaging/prometheus", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr

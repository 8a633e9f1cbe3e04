"""What the dashboard and the alert rules ask for, beside what a daemon gives."""

import json
import re
from pathlib import Path
from typing import Any

import yaml
from prometheus_client.parser import text_string_to_metric_families

from rigkit.service.control import Control
from rigkit.service.metrics import Metrics
from rigkit.service.slot import Slot
from rigkit.service.snapshot import as_bytes, snapshot
from tests.contract.source_tree import ROOT

DASHBOARD = ROOT / "packaging" / "grafana" / "vibrostage.json"
RULES = ROOT / "packaging" / "prometheus" / "vibrostage-rules.yml"
SCRAPES = ROOT / "packaging" / "prometheus" / "prometheus.yml"
RIG, DAEMON, VIBRATOR, STAGE = "Rig", "Daemon", "Vibrator", "Stage"
LINK, SIMULATED = "Stage behind its link", "Simulated stage"
OF_A_RULE = {"rig": RIG, "daemon": DAEMON, "vibrator": VIBRATOR, "link": LINK}
"""Which row of the dashboard a group of rules goes with."""
_OF_PROMETHEUS = {"up"}


def read(path: Path) -> Any:
    """Return what a file of JSON or YAML holds."""
    return json.loads(path.read_text()) if path.suffix == ".json" else yaml.safe_load(path.read_text())


def asked() -> list[tuple[str, str]]:
    """Return each expression of dashboard and rules, after the row that it belongs to."""
    found, row = [], ""
    for panel in read(DASHBOARD)["panels"]:
        row = panel["title"] if panel["type"] == "row" else row
        found += [(row, target["expr"]) for target in panel.get("targets", ())]
    for group in read(RULES)["groups"]:
        found += [(OF_A_RULE[group["name"]], rule["expr"]) for rule in group["rules"]]
    return found


def named(expression: str) -> set[str]:
    """Return the names of metrics in an expression; one that is a regular expression begins with "~".

    Examples
    --------
    >>> sorted(named('rate(vibrostage_ticks_total{job=~"$job"}[1m]) + {__name__=~"vibrostage_a_[0-9]+"}'))
    ['vibrostage_ticks_total', '~vibrostage_a_[0-9]+']
    """
    patterns = set(re.findall(r'__name__\s*=~\s*"([^"]*)"', expression))
    bare = re.sub(r'"[^"]*"|\{[^}]*\}|\[[^]]*\]|\b(?:on|by|ignoring)\s*\([^)]*\)', " ", expression)
    words = re.findall(r"\b[a-zA-Z_:][\w:]*\b(?!\s*\()", bare)
    return {f"~{each}" for each in patterns} | set(words) - {"and", "or", "unless", "bool", "by", "on"}


def missing(text: bytes | str, rows: tuple[str, ...]) -> set[str]:
    """Return the metrics that those rows ask for and the text of `/metrics` does not give."""
    told = text.decode() if isinstance(text, bytes) else text
    given = {sample.name for family in text_string_to_metric_families(told) for sample in family.samples}
    wanted = {name for row, expression in asked() if row in rows for name in named(expression)} - _OF_PROMETHEUS
    return {
        name
        for name in wanted
        if not any(re.fullmatch(name[1:], each) if name[0] == "~" else each == name for each in given)
    }


def missing_of(control: Control, *rows: str) -> set[str]:
    """Return the metrics that those rows ask for and a rig does not give as it stands."""
    slot = Slot()
    slot.put(as_bytes(snapshot(control, 1, 0, 0.0)))
    return missing(Metrics(slot, lambda: ()).text(), rows)

"""STUDY.toml: what is wrong with one is said in one line, with the file, the key and what is allowed."""

from pathlib import Path

import pytest

from rigkit.config import ConfigError
from tests.rigkit.study.small_study import STUDY, plan_of

WHOLE = STUDY % 4


def test_a_study_becomes_tasks_in_the_order_of_seeds(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, WHOLE.replace('["sequential"]', '["sequential", "uncertain"]'))
    tasks = [task for seed in plan.seeds() for task in seed]
    assert [(task.seed, task.case["planner"]) for task in tasks[:3]] == [
        (1, "sequential"),
        (1, "uncertain"),
        (2, "sequential"),
    ]
    assert tasks[2].commands[0][3:5] == ("--planner", "sequential")
    assert len({task.key for task in tasks}) == plan.count == 8


def test_a_task_has_another_key_when_a_file_that_it_is_given_has_changed(tmp_path: Path) -> None:
    before = plan_of(tmp_path)
    (tmp_path / "pocket.json").write_text("{}")
    after = type(before)(before.study, ("stagectl",), tmp_path)
    assert next(before.seeds())[0].key != next(after.seeds())[0].key


def test_machines_have_keys_inputs_and_a_name(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "a.csv").write_text("1")
    machines = '[machines.stiff]\n"joint.k" = 2.0\ninputs = ["runs"]\n[figures.total]'
    text = WHOLE.replace("plan pocket.json", "plan {input.1}/{machine.name} {machine}")
    (task,) = next(plan_of(tmp_path, text.replace("[figures.total]", machines)).seeds())
    assert task.commands[0][2:5] == (f"{tmp_path}/runs/stiff", "--set", "joint.k=2.0")
    (tmp_path / "runs" / "a.csv").write_text("2")
    (other,) = next(plan_of(tmp_path, text.replace("[figures.total]", machines)).seeds())
    assert (task.machine, task.commands) == (other.machine, other.commands)
    assert task.key != other.key


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("count = 4", "count = 0", "seeds.count is 0, must be >= 1 and <= 1000000 seeds"),
        ("count = 4", "cuont = 4", "seeds.cuont is 4, but [seeds] has no cuont; did you mean count?"),
        ('"stagectl plan', '"rm -rf', 'commands[0] begins with "rm", must be '),
        ('"stagectl plan', "\"stagectl '", "No closing quotation"),
        ("{seed}", "7", "seeds: no command has {seed}, so all would be the same"),
        ("{seed}", "{sed}", "there is no {sed}; there are machine, machine.name, planner, seed, settings"),
        ("{planner}", "exact", "settings: no command has {planner} or {settings}, so it would change nothing"),
        ('["sequential"]', '"sequential"', 'settings.values.planner is "sequential", must be a list of values'),
        ('["sequential"]', '["exact", "exact"]', "two tasks are the same: machine default, {'planner': 'exact'}"),
        ('path = "pockets[*].total"', 'path = "pockets[x]"', "figures.total: path 'pockets[x]' is none, at '[x]'"),
        ('path = "pockets[*].total"\n', "", "figures.total has no path, must have one"),
        ('unit = "s"', 'unti = "s"', "but a figure has no unti; did you mean un"),
        ('unit = "s"', 'kind = "event"', "figures.total.until is 0, must be > 0 for an event"),
        ("<= 27", "27", "figures.total.passes is \"27\", must be such as '<= 3' or '> 0.5'"),
        ('files = ["pocket.json"]', 'files = ["a/p", "b/p"]', "must have different names"),
        ("[seeds]", "[machines]\nx = 3\n[seeds]", "machines.x is 3, must be a table named by"),
        ("[settings.values]", '[settings]\nmethod = "list"\n[settings.values]', "settings.values is given, but"),
        ("[seeds]", '[machines.x]\ninputs = "a"\n[seeds]', "machines.x.inputs is 'a', must be a list of paths"),
        ("[seeds]", 'group = "gap"\n[seeds]', 'group is "gap", must be a figure of kind text'),
        ("[seeds]", "[machines.x]\nplanner = 1\n[seeds]", "planner is a key of the machine and of the settings"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in WHOLE
    with pytest.raises(ConfigError) as refused:
        plan_of(tmp_path, WHOLE.replace(old, new))
    assert said in str(refused.value)
    assert str(refused.value).startswith(f"{tmp_path}/study.toml: ")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("table", ["commands", "figures"])
def test_a_study_without_commands_or_figures_is_refused(tmp_path: Path, table: str) -> None:
    text = 'name = "x"\n' if table == "commands" else 'commands = ["vibractl doctor"]\n'
    with pytest.raises(ConfigError, match=f"study.toml: {table} is .*, must hold at least one"):
        plan_of(tmp_path, text)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"other\.json"):
        plan_of(tmp_path, WHOLE.replace('["pocket.json"]', '["other.json"]'))

"""A stage runs on models of its own axes, measured with the wiring that it has now."""

from dataclasses import replace
from pathlib import Path

import pytest

from calibration.state_space.model import InnovationModel
from rigkit import config as rig_file
from rigkit.agreement import DisagreementError
from stagectl.config import StageConfig
from stagectl.models.model_file import read_model
from stagectl.models.model_origin import refuse_foreign
from tests.stagectl.experiments.piezo.test_session import write_models


@pytest.fixture
def measured(tmp_path: Path) -> tuple[list[Path], list[InnovationModel]]:
    """Return a stage's models, each with its axis and the configuration that it was measured with."""
    files, text = write_models(tmp_path), rig_file.dump(StageConfig())
    names = StageConfig().stage.axes
    models = [
        replace(read_model(file), output_names=(f"position_{name}",), provenance={"config": text})
        for file, name in zip(files, names, strict=True)
    ]
    return list(files), models


def wired(**tables: dict[str, object]) -> StageConfig:
    """Return settings with some keys other than their defaults."""
    return StageConfig.model_validate(tables)


def test_models_of_this_stage_need_no_word(measured: tuple[list[Path], list[InnovationModel]]) -> None:
    assert refuse_foreign(StageConfig(), *measured, ()) == []


def test_models_in_another_order_are_refused(measured: tuple[list[Path], list[InnovationModel]]) -> None:
    files, models = measured
    with pytest.raises(ValueError, match="is of axis y, must be of x: models come in the order of stage.axes"):
        refuse_foreign(StageConfig(), [files[1], files[0], files[2]], [models[1], models[0], models[2]], ())


def test_another_wiring_is_refused_and_another_simulated_stage_is_said(
    measured: tuple[list[Path], list[InnovationModel]],
) -> None:
    other = wired(rig={"name": "another"})
    with pytest.raises(DisagreementError, match=r"rig.name was .*, is .another.*--accept rig.name"):
        refuse_foreign(other, *measured, ())
    assert len(refuse_foreign(other, *measured, ["rig.name"])) == 3
    assert len(refuse_foreign(wired(simulator={"options": {"seed": 3}}), *measured, ())) == 3

"""An experiment of which its rig file and its options say all: its command and its procedure are made from these."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from inspect import Parameter, Signature
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TextIO, TypeVar, get_args, get_origin

import typer
from pydantic.fields import FieldInfo

from rigkit import config as rig_file
from rigkit.allowed import unit
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, laid_over, words, write_json
from rigkit.config import Section
from rigkit.config_fault import checked
from rigkit.config_paths import keys
from rigkit.experiment.command import CommandLine, RunOption, refuse_png_alone
from rigkit.experiment.kept import create
from rigkit.experiment.kind import Experiment, Kind
from rigkit.experiment.procedure import ExperimentProcedure, View
from rigkit.service.paths import run_path
from rigkit.service.rig import Desk

OF_THE_DAEMON = ("run", "paced")
"""Keys of options that a command has no need of: it has --out, and the simulation goes as fast as it can."""


Made = TypeVar("Made", bound=Experiment)


@dataclass(frozen=True)
class ByOptions(Generic[Made]):
    """Both sides of an experiment.

    Parameters
    ----------
    kind : Kind
    config, options : subclasses of Section
        Of the rig file; and what it may be begun with: `run`, `paced`, and keys of its own, which are numbers, texts
        or true and false: each is an option of the command.
    live : str
        Key of the rig file that has it lead real devices.
    make : callable(config, options) -> Experiment
    title : callable(Experiment) -> str
    view : callable(Experiment) -> View
    tell : callable(figures, TextIO)
        Tells a person what came of it.
    """

    kind: Kind
    config: type[Section]
    options: type[Section]
    live: str
    make: Callable[[Any, Any], Made]
    title: Callable[[Made], str]
    view: Callable[[Made], View]
    tell: Callable[[dict[str, Any], TextIO], None]

    def command(self, purpose: str) -> Callable[..., None]:
        """Return the command, with `purpose` for its help."""

        def command(
            config: Path | None, live: bool, out: Path | None, png: Path | None, settings: Any, json: Any, **given: Any
        ) -> None:
            loaded = rig_file.load(config, self.config, laid_over(settings, {self.live: live}))
            refuse_png_alone(png, out)
            made = self.make(loaded, checked(self.options, given, "what is asked"))
            line = CommandLine(self.title(made), self._is_live(loaded), out, png, json)
            reasons, found = line.carry_out(self.kind, loaded, made)
            self.tell(found, words(json))
            write_json(json, found)
            line.end(reasons)

        parameters = self._parameters()
        command.__doc__, command.__annotations__ = purpose, {each.name: each.annotation for each in parameters}
        command.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
        return command

    def procedure(self, config: Any, options: Any, desk: Desk) -> ExperimentProcedure:
        """Return what the daemon runs.

        Raises
        ------
        ValueError, OSError : a live one is to be paced, or what is asked cannot be; no folder is made.
        """
        options.refuse_live(self.live, self._is_live(config))
        made = self.make(config, options)
        folder = create(run_path(config.daemon.data, options.run), self.kind, config, made)
        return ExperimentProcedure(
            self.kind, self.title(made), folder, made, self.view(made), desk, is_paced=options.paced
        )

    def _is_live(self, config: Section) -> bool:
        return bool(reduce(getattr, self.live.split("."), config))

    def _parameters(self) -> list[Parameter]:
        own = {name: field for name, field in self.options.model_fields.items() if name not in OF_THE_DAEMON}
        live = dict(keys(self.config))[tuple(self.live.split("."))].description
        every = {
            "config": (ConfigOption, None),
            "live": (Annotated[bool, typer.Option("--live", help=_sentence(live))], False),
            "out": (RunOption, None),
            "png": (PngOption, None),
            "settings": (SetOption, None),
            "json": (JsonOption, None),
        }
        found = {name: (_option(field), field.default) for name, field in own.items()} | every
        return [
            Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=of)
            for name, (of, default) in found.items()
        ]


def _option(field: FieldInfo) -> Any:
    """Return the option for a key; one that is one of some words takes any: `checked` refuses another in a line."""
    words_of: tuple[Any, ...] = get_args(field.annotation) if get_origin(field.annotation) is Literal else ()
    of = type(words_of[0]) if words_of else field.annotation
    metavar = "|".join(map(str, words_of)) or unit(field).upper() or None
    return Annotated[of, typer.Option(metavar=metavar, help=_sentence(field.description))]


def _sentence(text: str | None) -> str:
    return f"{(text or '')[:1].upper()}{(text or '')[1:]}."

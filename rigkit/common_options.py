"""What the options of all commands have in common: short names, --version, and what a shell completes them to."""

import inspect
import re
import sys
from collections.abc import Callable, Iterable
from copy import copy
from typing import Annotated, Any, get_args, get_origin

import typer
from typer.models import OptionInfo, ParameterInfo

from rigkit.provenance import software

SHORT = {
    "--accept": "-a",
    "--config": "-c",
    "--json": "-j",
    "--model": "-m",
    "--out": "-o",
    "--reference": "-r",
    "--set": "-s",
}
"""The short name that an option has wherever there is one of that name."""

_WORD = re.compile(r"[a-z][a-z0-9-]*")


def one_of(words: Iterable[str]) -> Callable[[str], list[str]]:
    """Return what completes an option or argument to these words; to a file where none begins as was typed."""
    known = sorted(words)

    def completed(incomplete: str) -> list[str]:
        return [word for word in known if word.startswith(incomplete)]

    return completed


def common(function: Callable[..., Any]) -> inspect.Signature:
    """Return a command's signature with what every command has: short names, completion and `--version`.

    Words of a metavar such as "band|reference" are what its option is completed to.
    """
    signature = inspect.signature(function, eval_str=True)
    its = [each.replace(annotation=_completed(each)) for each in signature.parameters.values()]
    version = inspect.Parameter("version", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=VersionOption)
    return signature.replace(parameters=[*its, version])


def name_of(parameter: inspect.Parameter, info: ParameterInfo) -> str:
    """Return the long name of an option, "--" and the rest."""
    declared = [info.default, *(info.param_decls or ())]  # within `Annotated` the first name stands as the default
    names = [each for each in declared if isinstance(each, str) and each.startswith("--")]
    return names[0] if names else f"--{parameter.name.replace('_', '-')}"


def _completed(parameter: inspect.Parameter) -> Any:
    """Return the annotation of a parameter, its option with a short name and with words to complete it to."""
    annotation = parameter.annotation
    info = next((each for each in get_args(annotation) if isinstance(each, OptionInfo)), None)
    if get_origin(annotation) is not Annotated or info is None:
        return annotation
    made, name = copy(info), name_of(parameter, info)
    words = [word for word in str(info.metavar or "").split("|") if _WORD.fullmatch(word)]
    if "|" in str(info.metavar or "") and info.autocompletion is None and info.shell_complete is None:
        made.autocompletion = one_of(words)
    if name in SHORT:
        declared = info.default if isinstance(info.default, str) else name
        made.default, made.param_decls = declared, (*(info.param_decls or ()), SHORT[name])
    held, *others = get_args(annotation)
    return Annotated[(held, *(made if each is info else each for each in others))]


def _say_version(is_wanted: bool) -> None:
    if is_wanted:
        sys.stdout.write(f"{software(())}\n")
        raise typer.Exit


VersionOption = Annotated[
    bool,
    typer.Option("--version", is_eager=True, callback=_say_version, help="Show the version and exit."),
]

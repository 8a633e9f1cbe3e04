"""The command lines of a task, from those of the study: placeholders become values, a table of keys becomes --set."""

import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rigkit.config import ConfigError
from rigkit.config_fault import shown
from rigkit.study.task import Words
from rigkit.toml_text import value_text

_PLACE = re.compile(r"\{([\w.-]+)\}")
MACHINE, SETTINGS, SEED, NAME = "machine", "settings", "seed", "machine.name"
"""Placeholders that every study has."""


class Lines:
    """The commands of a study, split into words.

    Parameters
    ----------
    commands : sequence of str
        `{KEY}` stands for the value of a machine's or a case's key; `{machine}` and `{settings}`, each a word of its
        own, for `--set KEY=VALUE` of all their keys that are not named elsewhere.  `{FILE.json:PATH}` stays for
        `rigkit.study.late_value`.
    programs : collection of str
        What a command may begin with.

    Raises
    ------
    ConfigError : a command is no command line, or begins with something else.
    """

    def __init__(self, commands: Sequence[str], programs: Iterable[str]) -> None:
        known = sorted(programs)
        self._lines = [_split(number, line) for number, line in enumerate(commands)]
        for number, line in enumerate(self._lines):
            if line[0] not in known:
                raise ConfigError(f"commands[{number}] begins with {shown(line[0])}, must be {' or '.join(known)}")
        self.named = {name for line in self._lines for word in line for name in _PLACE.findall(word)}
        """All placeholders."""

    def refuse_unused(self, machine: Iterable[str], case: Iterable[str], has_seeds: bool) -> None:
        """Refuse keys that no command would see, placeholders for nothing, and seeds that nobody takes.

        Parameters
        ----------
        machine, case : iterable of str
            Keys.
        has_seeds : bool
            Whether there is more than one.

        Raises
        ------
        ConfigError : the text names the key.
        """
        own, cased = set(machine), set(case)
        known = {MACHINE, SETTINGS, SEED, NAME, *own, *cased}
        if unknown := sorted(self.named - known):
            raise ConfigError(f"commands: there is no {{{unknown[0]}}}; there are {', '.join(sorted(known))}")
        for table, keys, whole in (("machines", own, MACHINE), ("settings", cased, SETTINGS)):
            if (unseen := sorted(keys - self.named)) and whole not in self.named:
                raise ConfigError(f"{table}: no command has {{{unseen[0]}}} or {{{whole}}}, so it would change nothing")
        if has_seeds and SEED not in self.named:
            raise ConfigError("seeds: no command has {seed}, so all would be the same")
        if both := sorted(own & cased):
            raise ConfigError(f"{both[0]} is a key of the machine and of the settings, must be of one")

    def of(self, machine: Mapping[str, Any], case: Mapping[str, Any], name: str, seed: int) -> tuple[Words, ...]:
        """Return the words of every command for one machine, case and seed."""
        words = {MACHINE: self._laid_over(machine), SETTINGS: self._laid_over(case)}
        texts = {key: _text(value) for key, value in {**machine, **case, NAME: name, SEED: seed}.items()}
        return tuple(tuple(_filled(line, words, texts)) for line in self._lines)

    def _laid_over(self, table: Mapping[str, Any]) -> Words:
        pairs = (("--set", f"{key}={_text(value)}") for key, value in table.items() if key not in self.named)
        return tuple(word for pair in pairs for word in pair)


def shell_line(words: Sequence[str]) -> str:
    """Return a command line as a shell takes it."""
    return shlex.join(words)


def _filled(line: Words, words: Mapping[str, Words], texts: Mapping[str, str]) -> Iterable[str]:
    for word in line:
        whole = _PLACE.fullmatch(word)
        if whole and whole[1] in words:
            yield from words[whole[1]]
        else:
            yield _PLACE.sub(lambda found: texts.get(found[1]) or " ".join(words.get(found[1], ())), word)


def _split(number: int, line: str) -> Words:
    try:
        words = tuple(shlex.split(line))
    except ValueError as fault:
        raise ConfigError(f"commands[{number}] is {shown(line)}: {fault}") from None
    if not words:
        raise ConfigError(f"commands[{number}] is {shown(line)}, must be a command line")
    return words


def _text(value: Any) -> str:
    return value if isinstance(value, str) else value_text(value)

"""The option of commands that take a reference."""

from typing import Annotated

import typer

from rigkit.common_options import one_of
from vibractl.reference_forms import FORMS, choices, written

ReferenceOption = Annotated[
    str | None, typer.Option(help=f"{choices('a WAV or CSV file')}.", autocompletion=one_of(map(written, FORMS)))
]

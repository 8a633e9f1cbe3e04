"""The option of commands that take a reference."""

from typing import Annotated

import typer

from vibractl.reference_forms import choices

ReferenceOption = Annotated[str | None, typer.Option(help=f"{choices('a WAV or CSV file')}.")]

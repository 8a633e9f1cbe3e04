"""The stage's frames as a DBC file; `make docs` writes stagectl/stage.dbc."""

from rigkit.wire import dbc
from stagectl.wire.messages import LAYOUTS


def dbc_text() -> str:
    """Return the DBC file."""
    return dbc.dbc_text(LAYOUTS, {"host": "stage", "stage": "host"})

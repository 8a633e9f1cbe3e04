"""The command line `vibrostage`: groups of commands that belong to no single rig."""

from rigkit.command import application
from vibrostage.study_command import study_app

app = application("What goes beyond one rig: studies over many machines, on every core or a cluster.")
app.add_typer(study_app, name="study")

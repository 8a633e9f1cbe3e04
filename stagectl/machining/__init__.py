"""Robot, tracker, stage and mid-ranging in one graph: the toroid."""

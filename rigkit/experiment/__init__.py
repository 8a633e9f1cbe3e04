"""Running an experiment: its parts one after another, recorded as they go, and made again from what was recorded."""

"""Whether a rig is fit to learn on: each property measured, with a verdict."""

"""Frames on a bus: from values to bytes and back, and as other tools read them; no I/O."""

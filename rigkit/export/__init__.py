"""Recordings in the formats of other programs, the same for every rig."""

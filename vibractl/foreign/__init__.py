"""Recordings that other programs made: read, timed, judged, learned from."""

"""Trials of a milled path: run, recorded, measured, and learned from."""

"""Experiments that end in a model file."""

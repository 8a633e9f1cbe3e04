"""Experiments with stage and robot: of each its netlist, its order of events and its figures."""

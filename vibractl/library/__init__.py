"""Learned drives kept for later runs: what a warm start begins with."""

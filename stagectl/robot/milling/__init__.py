"""Milling by a robot: how it learns its path, and how it controls its force."""

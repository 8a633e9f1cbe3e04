"""Identification on anybody's measurement, from the file to the report."""

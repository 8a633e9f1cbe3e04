"""The robot cell under the daemon: its procedures, gauges and panels."""

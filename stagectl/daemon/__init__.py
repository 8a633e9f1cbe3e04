"""The stage under the daemon: its procedures, gauges and panels."""

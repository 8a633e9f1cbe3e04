"""The vibrator under the daemon: its procedures, gauges and panels."""

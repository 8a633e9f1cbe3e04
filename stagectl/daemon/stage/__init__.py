"""The piezo stage under the daemon."""

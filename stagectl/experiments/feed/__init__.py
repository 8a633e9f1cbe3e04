"""Milling with force-controlled feed: `stagectl force`."""

"""The doors for people at a prompt: the umbrella command; no mathematics of its own."""

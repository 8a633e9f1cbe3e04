"""The stage's own control at 10 kHz: what runs on its processor, and in the host at one sample a tick."""

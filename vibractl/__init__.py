"""The marine vibrator: learns, shot by shot, to emit exactly the reference."""

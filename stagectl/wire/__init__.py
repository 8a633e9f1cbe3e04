"""What the host and the stage's processor say to each other: bytes to SI numbers and back, without I/O."""

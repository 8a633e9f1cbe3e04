"""The host's end of the wires: the stage behind a CAN adapter."""

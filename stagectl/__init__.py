"""The piezo micro manipulator, 10 kHz: its controllers, the wire to its processor, and the record of its model."""

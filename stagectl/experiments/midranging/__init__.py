"""The macro and the micro manipulator share one position."""

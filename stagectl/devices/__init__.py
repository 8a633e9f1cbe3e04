"""What surrounds the controllers: robots, trackers, sensors, and the signals they have."""

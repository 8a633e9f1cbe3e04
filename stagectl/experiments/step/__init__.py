"""Steps and multisines on the robot, on the stage, or on one after the other: delay, gain and bandwidth of each."""

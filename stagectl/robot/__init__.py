"""The robot beside the stage: kinematics, and what moves it."""

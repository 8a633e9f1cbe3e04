"""Backlash, stiffness and friction of a robot's joints, from torque-position maps of a clamped arm (ch. 4)."""

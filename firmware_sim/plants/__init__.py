"""The physics of simulated plants; none of it is built from the controllers' own code."""

"""Half an hour of live commands over the simulated wires of a robot cell, with every silence counted and attributed."""

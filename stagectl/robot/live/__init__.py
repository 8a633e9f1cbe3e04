"""A trial's other end over its wires: what robot, tracker and force sensor say, tick by tick of a graph."""

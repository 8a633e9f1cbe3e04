"""The program around a graph, the same for every rig: settings, run folder, command line, report."""

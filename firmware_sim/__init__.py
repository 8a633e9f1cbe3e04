"""The other end of each wire: a simulated laboratory that the program cannot tell from a real one."""

"""The daemon, the same for every rig: a rig hands it procedures and gauges; it has states, access, API and page."""

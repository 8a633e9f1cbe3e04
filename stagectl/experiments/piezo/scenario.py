"""Scenarios: settings laid over a rig file so that one word runs a known experiment."""

from stagectl.config import Session

MILLING = "firmware_sim.stage_blocks:Milling"
POSITIONS = {"x": "[225e-6]", "y": "[225e-6, 375e-6, 225e-6]", "z": "[225e-6]"}
"""m: the y cut deflects the robot to one side by more than half of the travel [Sörnmo 2015, fig. 2.16]."""
SHORTEST, LONGEST = 5.0, 120.0
"""s, of a cut."""


def scenario_settings(name: str, session: Session) -> list[str]:
    """Return the settings of a scenario, "table.key=value" each.

    Parameters
    ----------
    name : str
        milling-x, milling-y or milling-z: a cut against that axis on a robot that gives way, first without and then
        with the stage compensating what the laser sees.
    session : Session
        The cut is as long as the run.

    Raises
    ------
    ValueError : there is no such scenario.
    """
    kind, _, axis = name.partition("-")
    if kind != "milling" or axis not in POSITIONS:
        known = ", ".join(f"milling-{each}" for each in POSITIONS)
        raise ValueError(f"scenario is {name!r}, must be one of {known}")
    if not SHORTEST <= session.seconds <= LONGEST:
        raise ValueError(
            f"session.seconds is {session.seconds:g} s, must be {SHORTEST:g} to {LONGEST:g} s for scenario {name}"
        )
    compared = [f"reference.position={POSITIONS[axis]}", "deflection.on=true", "session.compare=true"]
    if session.live:  # what mills there is no simulator's
        return compared
    cut = f'direction = "{axis}", start = {session.lead!r}, seconds = {session.seconds!r}'
    return [
        f"simulator.surroundings={MILLING}",
        f"simulator.surroundings_options={{{cut}}}",
        *compared,
    ]

"""How a planned path is cut: what it does not tell itself."""

from dataclasses import dataclass

from stagectl.planning.problem import PocketFault


@dataclass(frozen=True)
class Cutting:
    """What a path does not tell.

    Parameters
    ----------
    cell : float, m
        Side of a cell: the tool's diameter over G.
    depth : float, m
        Of the cut below the surface.
    clearance : float, m
        Of a lifted tool above the surface.
    speed : float, m/s
        Of moves and lifts.
    """

    cell: float = 2e-3
    depth: float = 3e-3
    clearance: float = 5e-3
    speed: float = 0.1

    def __post_init__(self) -> None:
        """Refuse what no machine can drive."""
        for name in ("cell", "depth", "clearance", "speed"):
            if not 0.0 < getattr(self, name) < float("inf"):
                raise PocketFault(f"{name} is {getattr(self, name)}, must be > 0")

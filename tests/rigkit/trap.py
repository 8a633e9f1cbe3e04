"""Code that a rig file must not get to run: each call leaves a mark."""

called: list[str] = []


class Trap:
    """A class that is neither a Block nor a device."""

    def __init__(self, *_: object, **__: object) -> None:
        called.append("Trap")

    @classmethod
    def from_config(cls, _: object) -> object:
        called.append("from_config")
        return cls


def trap(*_: object, **__: object) -> None:
    """Do what a shell would."""
    called.append("trap")

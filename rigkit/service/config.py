"""The daemon's table of a rig file."""

from rigkit.config import Section, setting


class Daemon(Section):
    """The service that `daemon` runs: its address, access and data folder."""

    role = "patience"

    address: str = setting(
        "127.0.0.1:8787",
        "",
        "host:port, or unix:/path for a socket in the file system",
        pattern=r"^(unix:/.+|(\[[0-9a-fA-F:]+\]|[\w.-]+):\d{1,5})$",
    )
    data: str = setting(
        "data", "", "folder of runs, models, token file and event log; made if absent", min_length=1, files=("",)
    )
    hosts: tuple[str, ...] = setting((), "", "further names, as in a browser's address, by which it may be reached")
    certificate: str = setting("", "", "file of a TLS certificate and its chain (PEM)", files=("",))
    key: str = setting("", "", "file of its private key (PEM)", files=("",))
    plain: bool = setting(False, "", "allow other computers to connect without TLS")
    clients: int = setting(20, "", "pages and programs that may watch at a time", ge=1, le=200)
    requests: float = setting(50.0, "1/s", "requests allowed from one address, long-term average", ge=1, le=1_000)
    lease: float = setting(30.0, "s", "control that is not used is released after this", ge=2, le=3_600)
    mute_after: float = setting(
        0.1, "s", "the drive fades to zero when the program has not responded for so long", ge=0.05, le=10
    )
    plotjuggler: str = setting("", "", "host:port to which gauges go as JSON over UDP; none if empty")
    faults: bool = setting(False, "", "allow `fault`, which injects faults into the rig's signals")

"""The daemon's table of a rig file."""

from rigkit.config import Section, setting


class Daemon(Section):
    """The service that `daemon` runs: who reaches it, and where it keeps things."""

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
    plain: bool = setting(False, "", "let others than this machine reach it without TLS")
    clients: int = setting(20, "", "pages and programs that may watch at a time", ge=1, le=200)
    requests: float = setting(50.0, "1/s", "requests that one address may make, in the long run", ge=1, le=1_000)
    lease: float = setting(30.0, "s", "control that is not used is free after this", ge=2, le=3_600)
    mute_after: float = setting(
        0.1, "s", "the drive fades to zero when the program has given no sign for so long", ge=0.05, le=10
    )
    plotjuggler: str = setting("", "", "host:port to which gauges go as JSON over UDP; none if empty")
    faults: bool = setting(False, "", "allow `fault`, which puts faults into the rig's signals on purpose")

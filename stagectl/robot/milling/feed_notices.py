"""What force control has noticed, in words."""

from stagectl.robot.milling.feed_record import BRAKED, CHATTER, MODEL, OSCILLATION, RIPPLE, SCALE, UNKNOWN

NOTICES = {
    UNKNOWN: "control begins although kappa and beta are uncertain",
    MODEL: "the robot no longer follows as identified: control continues without the velocity model",
    OSCILLATION: "the force oscillates: control continues with slower gains",
    CHATTER: "the tool chatters: the feed is lowered",
    RIPPLE: "the force has a ripple, which is not fed back",
    BRAKED: "the force rose at once: the feed was braked",
    SCALE: "kappa is none that is known of this material: another material, depth or tool, or the force sensor's scale",
}
"""By bit of the port `notice`."""

NAMES = {
    UNKNOWN: "unknown",
    MODEL: "model",
    OSCILLATION: "oscillation",
    CHATTER: "chatter",
    RIPPLE: "ripple",
    BRAKED: "braked",
    SCALE: "scale",
}
"""Keys of the same for other programs."""


def words(bits: int) -> list[str]:
    """Return in words what the bits of the port `notice` say."""
    return [text for bit, text in NOTICES.items() if bits & bit]

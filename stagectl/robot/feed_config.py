"""The table of the robot cell's file that force-controlled feed reads."""

from typing import Literal

from rigkit.config import Section, setting


class ForceFeed(Section):
    """Force-controlled feed: the set-point, the prior of the material, adaptation, and limits."""

    force: float = setting(10.0, "N", "wanted: of the horizontal force on the tool", gt=0, le=1e3)
    stiffness: float = setting(75e3, "N/m", "K_f, of tool, robot and workpiece together", ge=1e3, le=1e7)
    kappa: float = setting(4e-4, "m/(N s)", "first guess of the rate of removal for a force", ge=1e-5, le=0.1)
    beta: float = setting(0.5, "", "first guess of the force across the feed over that against it", ge=-5, le=5)
    kappa_deviation: float = setting(2e-3, "m/(N s)", "standard deviation of that guess, at each segment", gt=0, le=1)
    beta_deviation: float = setting(0.5, "", "standard deviation of that guess, at each segment", gt=0, le=10)
    kappa_drift: float = setting(1e-4, "m/(N s)", "by which kappa wanders in a second", gt=0, le=1)
    beta_drift: float = setting(0.1, "", "by which beta wanders in a second", gt=0, le=10)
    force_noise: float = setting(0.15, "N", "standard deviation of the force sensor's noise", gt=0, le=100)
    velocity_noise: float = setting(3e-4, "m/s", "standard deviation of the velocity's noise", gt=0, le=0.1)
    activation: float = setting(
        2.0, "", "control begins when both deviations are below so many times their steady-state values", gt=1, le=100
    )
    hesitation: float = setting(0.3, "s", "time after which control begins even so", ge=0.004, le=60)
    start: Literal["gentle", "constant"] = setting(
        "gentle", "", "before that: the feed rises until the force suffices, or is `initial`, as in the thesis"
    )
    initial: float = setting(
        15e-3, "m/s", "v_init: feed before control; gentle: highest before the tool touches", gt=0, le=0.2
    )
    approach: float = setting(3e-3, "m/s", "gentle: feed to begin with", gt=0, le=0.2)
    rise: float = setting(0.1, "s", "gentle: time in which it grows by a factor of e", ge=0.01, le=10)
    enough: float = setting(0.5, "", "gentle: until this share of the force wanted is there", gt=0, le=1)
    contact: float = setting(1.0, "N", "force above which the tool is in contact, and estimation runs", gt=0, le=100)
    lost: float = setting(0.1, "s", "time below half of that after which contact is lost", ge=0.004, le=10)
    highest: float = setting(0.1, "m/s", "feed", gt=0, le=0.25)
    acceleration: float = setting(2.0, "m/s^2", "of the feed wanted", gt=0, le=100)
    overload: float = setting(80.0, "N", "force at which the tool retracts", gt=0, le=1e3)
    blind: float = setting(0.02, "s", "time without a valid force after which the tool retracts", ge=0.004, le=1)
    stuck: float = setting(
        0.2, "s", "time with an exactly constant force after which the tool retracts", ge=0.02, le=10
    )
    retreat: float = setting(0.02, "m/s", "speed of a retract, back along the segment", gt=0, le=0.2)
    distance: float = setting(2e-3, "m", "distance of a retract", gt=0, le=0.1)
    integral: float = setting(
        0.05, "s", "outer loop: time in which the integral weighs as the force itself", gt=0, le=10
    )
    effort: float = setting(
        1.0, "", "outer loop: weight of the feed, as the force it makes at the integral's frequency", gt=0, le=1e3
    )
    adapted: bool = setting(True, "", "outer loop: gains follow kappa and beta, else they are those of the first guess")
    renewal: float = setting(
        1.5, "", "outer loop: gains are renewed where kappa has changed by such a factor since", gt=1, le=10
    )
    ripple: float = setting(
        0.05,
        "",
        "part of the force from which on a ripple above 30 Hz is not fed back",
        gt=0,
        le=10,
    )
    brake: float = setting(
        1.2,
        "",
        "times the force wanted, and twice its usual scatter, beyond which the feed is braked",
        ge=1.05,
        le=100,
    )
    familiar: float = setting(
        1e4,
        "",
        "kappa of this material is within such a factor of `kappa`, else it is noticed; 10000 where not known",
        ge=1.1,
        le=1e4,
    )
    chatter: float = setting(
        0.7, "", "once the tool chatters, the feed is at most that part of what it was", gt=0, lt=1
    )
    chattering: float = setting(
        2.0, "s", "of chatter that goes on though the feed was lowered three times: the tool retreats", ge=0.1, le=3_600
    )
    careful_lag: float = setting(
        0.06,
        "s",
        "outer loop: robot's lag, once it does not follow as identified or the loop oscillates",
        gt=0,
        le=10,
    )
    careful_integral: float = setting(0.15, "s", "outer loop: `integral` in that case", gt=0, le=10)
    velocity_integral: float = setting(0.05, "s", "inner loop: as `integral`, of velocity", gt=0, le=10)
    velocity_effort: float = setting(
        1.0, "", "inner loop: weight of the reference beside that of the velocity", gt=0, le=1e3
    )
    doubt: float = setting(
        0.3, "", "inner loop: rms noise at the model's input over that of its innovations", ge=0, le=100
    )

"""Which vibrator, in what, and what happens to it as time passes: the keywords of `[simulator.options]`."""

from dataclasses import dataclass

from firmware_sim.plants.options import choice, option, refuse_wrong_options


@dataclass(eq=False, kw_only=True)
class VibratorOptions:
    """What every plant with a simulated vibrator in it is built with.

    Parameters
    ----------
    seed : int
        Which vibrator: masses, springs, modes, drift and noise are drawn from it.
    nonlinearity : float, 1
        Scales every nonlinear force.
    drift : float, 1
        Each mode's frequency swings by this part of itself, each in its own 10 to 40 minutes.
    noise : float, dB re 10 m/s^2
        The accelerometers' white noise, rms.
    hum : float, dB re 10 m/s^2
        Amplitude of the mains' pick-up; its third harmonic is 20 dB weaker.
    hum_frequency : float, Hz
    medium : str
        "air", or "water": modes lower, closer together and more damped (`firmware_sim.plants.immersion`).
    trend : float, 1
        All modal frequencies move together by this part of themselves, steadily over the first `trend_seconds`; then
        they stay.  0.02 raises them by 2 %.
    trend_seconds : float, s
    moving_mode : float, Hz
        The mode nearest to here moves by itself; 0 for none.
    moving_widths : float, half-power bandwidths (2 zeta f) of that mode
        How far it moves, up if > 0.
    moving_at, moving_seconds : float, s
        When it begins to move, and how long it moves; 0 for a jump.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    nonlinearity: float = option(1.0, "1", 0.0, 5.0)
    drift: float = option(0.002, "1", 0.0, 0.1)
    noise: float = option(-75.0, "dB", -400.0, 0.0)
    hum: float = option(-60.0, "dB", -400.0, 0.0)
    hum_frequency: float = option(50.0, "Hz", 16.0, 400.0)
    medium: str = choice("air", "water")
    trend: float = option(0.0, "1", -0.2, 0.2)
    trend_seconds: float = option(600.0, "s", 1.0, 1e6)
    moving_mode: float = option(0.0, "Hz", 0.0, 1300.0)
    moving_widths: float = option(1.0, "half-power bandwidths", -10.0, 10.0)
    moving_at: float = option(60.0, "s", 0.0, 1e6)
    moving_seconds: float = option(0.0, "s", 0.0, 1e6)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)

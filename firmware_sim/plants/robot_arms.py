"""The arms that can be simulated, as numbers: geometry, masses, joints, drives."""

from dataclasses import dataclass

import numpy as np

Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Arm:
    """One kind of arm; all that belongs to a joint is seen from the arm's side of its gear.

    Parameters
    ----------
    chain : 6 rows of angle offset (deg), d (m), a (m), alpha (deg), standard Denavit-Hartenberg
    home : deg, 6 joints, where the simulation begins
    mass : kg, 6 links
    centre : m, 6 rows x y z, centres of mass, each in its link's own frame
    gyration : m, 6 links, radius of gyration about every axis through that
    stiffness, across : N m/rad, 6 joints, about the axis and about the two across it
    motor_inertia : kg m^2, 6 drives
    coulomb, viscous : N m and N m s/rad, 6 joints
    torque_limit : N m, 6 drives
    """

    chain: tuple[tuple[float, float, float, float], ...]
    home: Six
    mass: Six
    centre: tuple[tuple[float, float, float], ...]
    gyration: Six
    stiffness: Six
    across: Six
    motor_inertia: Six
    coulomb: Six
    viscous: Six
    torque_limit: Six

    @property
    def links(self) -> np.ndarray:
        """Chain in rad and m, then centre, mass and radius of gyration: shape (7, 9); the last row is for a payload."""
        table = np.zeros((7, 9))
        table[:6, :4] = self.chain
        table[:, [0, 3]] = np.deg2rad(table[:, [0, 3]])
        table[:6, 4:7], table[:6, 7], table[:6, 8] = self.centre, self.mass, self.gyration
        return table


IRB140 = Arm(
    chain=(
        (0.0, 0.352, 0.070, -90.0),
        (-90.0, 0.0, 0.360, 0.0),
        (0.0, 0.0, 0.0, -90.0),
        (0.0, 0.380, 0.0, 90.0),
        (0.0, 0.0, 0.0, -90.0),
        (180.0, 0.065, 0.0, 0.0),
    ),
    home=(0.0, 0.0, 0.0, 0.0, 30.0, 0.0),
    mass=(35.0, 16.0, 16.0, 6.0, 2.5, 0.5),
    centre=(
        (-0.05, 0.08, 0.0),
        (-0.19, 0.0, 0.05),
        (0.0, 0.0, 0.03),
        (0.0, -0.16, 0.0),
        (0.0, 0.0, 0.02),
        (0.0, 0.0, -0.02),
    ),
    gyration=(0.15, 0.12, 0.10, 0.07, 0.04, 0.03),
    stiffness=(5.0e4, 9.0e4, 5.0e4, 9.0e3, 8.0e3, 5.0e3),
    across=(1.5e6, 1.5e6, 2.5e5, 2.0e5, 1.5e5, 1.5e5),
    motor_inertia=(1.5, 2.5, 1.2, 0.12, 0.10, 0.05),
    coulomb=(8.0, 9.0, 6.0, 1.4, 1.2, 0.6),
    viscous=(8.0, 10.0, 6.0, 1.2, 1.0, 0.6),
    torque_limit=(350.0, 550.0, 280.0, 70.0, 60.0, 35.0),
)
"""Chain from the manufacturer's numbers (ros-industrial/abb_experimental irb140_support; Corke's robotics
toolbox); 98 kg in all [ABB, Product specification IRB 140].  How masses are spread, stiffness, friction and drives are
assumed, so that the lowest mode is where such arms have it, and so that joint 3 is soft across its axis, as on the arm
of Sörnmo 2015, sec. 4.5."""

KUKA = Arm(
    chain=(
        (0.0, 0.675, 0.350, -90.0),
        (-90.0, 0.0, 1.150, 0.0),
        (0.0, 0.0, 0.041, -90.0),
        (0.0, 1.200, 0.0, 90.0),
        (0.0, 0.0, 0.0, -90.0),
        (180.0, 0.215, 0.0, 0.0),
    ),
    home=(0.0, -10.0, 10.0, 0.0, 30.0, 0.0),
    mass=(350.0, 180.0, 220.0, 60.0, 35.0, 10.0),
    centre=(
        (-0.20, 0.20, 0.0),
        (-0.60, 0.0, 0.15),
        (0.0, 0.0, 0.10),
        (0.0, -0.55, 0.0),
        (0.0, 0.0, 0.06),
        (0.0, 0.0, -0.05),
    ),
    gyration=(0.40, 0.35, 0.30, 0.20, 0.12, 0.08),
    stiffness=(3.8e6, 6.6e6, 3.9e6, 5.6e5, 6.6e5, 4.7e5),
    across=(8.0e7, 1.0e8, 3.0e7, 1.2e7, 1.0e7, 1.0e7),
    motor_inertia=(300.0, 400.0, 200.0, 25.0, 20.0, 10.0),
    coulomb=(250.0, 300.0, 200.0, 50.0, 45.0, 25.0),
    viscous=(300.0, 350.0, 250.0, 60.0, 50.0, 30.0),
    torque_limit=(9.0e3, 1.6e4, 9.0e3, 2.2e3, 2.0e3, 1.2e3),
)
"""A KUKA-like arm of 240 kg payload and 2.7 m reach; every number is of the size that such arms have, none is measured.
Stiffness and masses are chosen together so that the lowest mode is between 10 and 30 Hz."""

ARMS = {"irb140": IRB140, "kuka": KUKA}

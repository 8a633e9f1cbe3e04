"""The simulated laboratory: a plant block between the converters of an audio card, wired as on the bench."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ctlblocks.block import Block
from rigkit.config import ConfigError
from rigkit.named_code import named_block

PLANTS = {
    "vibrator": "firmware_sim.plant_blocks:Vibrator",
    "vibrator-array": "firmware_sim.plant_blocks:VibratorArray",
    "impulse-response": "firmware_sim.plant_blocks:ImpulseResponse",
    "vibrator-impulse-response": "firmware_sim.plant_blocks:VibratorImpulseResponse",
}

_WARM_UP = 1024
"""Samples, after which a plant has called every kernel that it has."""


@dataclass(frozen=True)
class Wiring:
    """Which converter channel goes where, and what digital full scale is worth.

    Parameters
    ----------
    drive_channels : tuple of int, output channel of each drive, counted from 1
    response_channels : tuple of int, input channel of each accelerometer
    loopback_output, loopback_input : int, the two ends of the loopback cable
    output_full_scale : float, V
    input_full_scale : float, m/s^2
    far_field_channels : tuple of int, input channel of each hydrophone or microphone; empty where none is plugged in
    far_field_full_scale : float, Pa
    """

    drive_channels: tuple[int, ...] = (1, 2)
    response_channels: tuple[int, ...] = (1, 2)
    loopback_output: int = 3
    loopback_input: int = 3
    output_full_scale: float = 10.0
    input_full_scale: float = 400.0
    far_field_channels: tuple[int, ...] = ()
    far_field_full_scale: float = 200.0

    @classmethod
    def of(cls, audio: Any) -> Self:
        """Return the wiring that a rig file's `[audio]` says; what it does not say is as by default.

        Parameters
        ----------
        audio : any object with attributes named as these parameters
        """
        return cls(**{key: getattr(audio, key) for key in cls.__dataclass_fields__ if hasattr(audio, key)})

    @property
    def outputs(self) -> int:
        """Output channels of the card."""
        return max(*self.drive_channels, self.loopback_output)

    @property
    def inputs(self) -> int:
        """Input channels of the card."""
        return max(*self.response_channels, self.loopback_input, *self.far_field_channels)


class Laboratory:
    """From what the card plays to what it records: drives to the plant, responses back, the cable from end to end.

    Converters saturate at full scale.  Not modelled: their noise, their filters and crosstalk.

    Parameters
    ----------
    plant : Block
        One input in V, one output in m/s^2; there may be a second in Pa.
    wiring : Wiring
        As many drives and accelerometers as the plant has, and as many hydrophones, or none.
    """

    def __init__(self, plant: Block, wiring: Wiring) -> None:
        _refuse_wrong_ports(plant, wiring)
        self.plant, self.wiring = plant, wiring
        self._drive = np.zeros((0, 1))
        self._heard: list[np.ndarray] = []

    def prepare(self, rate: float, frames: int) -> None:
        """Put the plant at rest, all its kernels compiled, for steps of `frames` samples at `rate` samples/s."""
        self._drive = np.zeros((frames, self.plant.inputs[0].width))
        self._heard = [np.zeros((frames, port.width)) for port in self.plant.outputs]
        self.plant.prepare(rate, frames)
        for _ in range(-(-_WARM_UP // frames)):  # seconds in the first callback would be a card that stands still
            self.plant.process(self._drive, *self._heard)
        self.plant.prepare(rate, frames)

    def step(self, played: np.ndarray, recorded: np.ndarray) -> None:
        """Run the plant over one block.

        Parameters
        ----------
        played : array, shape (frames, outputs), full scale
            A channel that is not there plays nothing.
        recorded : array, shape (frames, inputs), full scale
            Filled; channels with nothing on them are silent.
        """
        wiring = self.wiring
        for column, channel in enumerate(wiring.drive_channels):
            if channel <= played.shape[1]:
                self._drive[:, column] = played[:, channel - 1]
        np.clip(self._drive, -1.0, 1.0, out=self._drive)
        self._drive *= wiring.output_full_scale
        self.plant.process(self._drive, *self._heard)
        recorded.fill(0.0)
        wires = (
            (wiring.response_channels, wiring.input_full_scale),
            (wiring.far_field_channels, wiring.far_field_full_scale),
        )
        for heard, (channels, full_scale) in zip(self._heard, wires, strict=False):  # a plant may have no far field
            heard *= 1.0 / full_scale
            for column, channel in enumerate(channels):
                if channel <= recorded.shape[1]:
                    recorded[:, channel - 1] = heard[:, column]
        if wiring.loopback_output <= played.shape[1] and wiring.loopback_input <= recorded.shape[1]:
            recorded[:, wiring.loopback_input - 1] = played[:, wiring.loopback_output - 1]
        np.clip(recorded, -1.0, 1.0, out=recorded)


def plant_block(name: str, options: dict[str, Any]) -> Block:
    """Build the plant that a rig file names.

    Parameters
    ----------
    name : str
        "vibrator", "impulse-response", or "package.module:Class" of a Block.
    options : dict
        The keywords it is built with.

    Returns
    -------
    Block

    Raises
    ------
    ValueError : there is no such plant, it does not know an option, or it refuses one.
    """
    if name not in PLANTS and ":" not in name:
        raise ValueError(
            f"simulator.plant is {name!r}, must be {', '.join(PLANTS)}, or package.module:Class of a Block"
        )
    try:
        return named_block(PLANTS.get(name, name), options)
    except ConfigError as fault:
        raise ValueError(f"simulator.plant, {fault}") from fault


def _refuse_wrong_ports(plant: Block, wiring: Wiring) -> None:
    inputs, outputs = ([(port.unit, port.width) for port in side] for side in (plant.inputs, plant.outputs))
    hydrophones = len(wiring.far_field_channels)
    drives = [("V", len(wiring.drive_channels))]
    heard = [("m/s^2", len(wiring.response_channels)), *([("Pa", hydrophones)] if hydrophones else [])]
    plugged = [*outputs[:1], *(port for port in outputs[1:] if hydrophones or port[0] != "Pa")]
    if (inputs, plugged) != (drives, heard):
        raise ValueError(
            f"the plant {type(plant).__name__} has inputs {_told(inputs)} and outputs {_told(outputs)}, must have "
            f"{_told(drives)} and {_told(heard)}, as audio.drive_channels, audio.response_channels and "
            "audio.far_field_channels are wired"
        )


def _told(ports: list[tuple[str, int]]) -> str:
    """Say how many channels there are of each unit."""
    return ", ".join(f"{width} x {unit}" for unit, width in ports) or "none"

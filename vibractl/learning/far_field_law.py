"""The learning law where hydrophones say what is wrong: the plant is T G, from coils to hydrophones."""

from dataclasses import replace

import numpy as np

from vibractl.far_field import FarField
from vibractl.fft_plans import Plans
from vibractl.learning.law import Law, bounded_inverse, first_law
from vibractl.learning.laws import Plant
from vibractl.place import Place
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import TransferMatrix


def far_field_law(law: Law, matrix: TransferMatrix, far: FarField, place: Place, rate: float, plans: Plans) -> Law:
    """Return a law that learns from hydrophones what another one would learn from accelerometers.

    Parameters
    ----------
    law : Law
        Of the accelerometers.
    matrix : TransferMatrix
        G of the whole rig: all shells are heard, whichever of them are controlled.
    far : FarField
    place : Place
        Of the hydrophones.
    rate : float, samples/s, of the place's reference
    plans : Plans

    Source
    ------
    Sörnmo 2015, eq. (6.16), (6.19), with T G for G.
    """
    if law.settings.structure == "decentralised":
        raise ValueError("learning.structure is decentralised: learning.sensors is far-field, must be accelerometers")
    frequency = law.matrix.frequency
    given, doubt = matrix.at(frequency), far.at(frequency).prompt.variance
    response, heard = given.response @ law.spread, place.transfer
    variance = np.abs(heard) ** 2 @ (given.variance @ np.abs(law.spread)) + doubt @ np.abs(response) ** 2
    product = heard @ response
    power = np.abs(product) ** 2
    plant = TransferMatrix(frequency, product, variance, power / (power + variance), law.matrix.provenance)
    band = frequency[0], frequency[-1]
    spectrum = LineSpectrum(len(place.reference), len(place.sensors), rate, band, plans)
    wanted = spectrum.lines(law.window * place.reference)
    inverse = bounded_inverse(product, law.settings)
    start = first_law(law.settings).first(Plant(product, inverse, wanted)) * law.active[:, None]
    return replace(law, matrix=plant, inverse=inverse, reference=wanted, start=start)


def shared_text(law: Law, hydrophones: int) -> str:
    """Say what is left open where there are fewer hydrophones than driven coils; nothing where there are not."""
    coils = law.matrix.inputs
    if hydrophones >= coils:
        return ""
    return (
        f"{hydrophones} hydrophone{'s' * (hydrophones > 1)} and {coils} coils: only what they do together at the "
        "hydrophones is controlled, by the smallest drives that do it; what each shell does by itself is left open"
    )

"""The two checksums of the stage's frames: CRC-8 for 8 bytes, CRC-16 for 64."""

import binascii

_POLYNOMIAL = 0x1D
_TOP = 0x80


def crc8(data: bytes, start: int = 0xFF) -> int:
    """Return the CRC-8 SAE J1850 of `data`, without its final inversion: every burst of up to 8 bits is seen.

    Parameters
    ----------
    data : bytes
    start : int
        The remainder to go on from.

    Source
    ------
    SAE J1850; AUTOSAR CRC library, CRC8 profile: polynomial 1Dh, initial value FFh.

    Examples
    --------
    >>> hex(crc8(b"123456789") ^ 0xFF)
    '0x4b'
    """
    for byte in data:
        start = _TABLE[start ^ byte]
    return start


def crc16(data: bytes, start: int = 0xFFFF) -> int:
    """Return the CRC-16/IBM-3740 ("CCITT-FALSE") of `data`: every burst of up to 16 bits is seen.

    Parameters
    ----------
    data : bytes
    start : int
        The remainder to go on from.

    Source
    ------
    AUTOSAR CRC library, CRC16 profile: polynomial 1021h, initial value FFFFh.

    Examples
    --------
    >>> hex(crc16(b"123456789"))
    '0x29b1'
    """
    return binascii.crc_hqx(data, start)


def _remainder(byte: int) -> int:
    for _ in range(8):
        byte = ((byte << 1) ^ _POLYNOMIAL if byte & _TOP else byte << 1) & 0xFF
    return byte


_TABLE = bytes(_remainder(byte) for byte in range(256))

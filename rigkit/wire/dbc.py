"""Frames as a DBC file, so that anybody's CAN tool decodes the traffic."""

import math
from collections.abc import Iterator, Mapping, Sequence

from rigkit.wire.layout import Field, Layout

_FD_FRAME, _CLASSIC_FRAME = 14, 0
"""VFrameFormat of a standard frame, as Vector's tools number them."""


def dbc_text(layouts: Sequence[Layout], receivers: Mapping[str, str]) -> str:
    """Return a DBC file.

    Parameters
    ----------
    layouts : sequence of Layout
    receivers : mapping of str to str
        By each node that may send, the node that what it sends is for.

    Source
    ------
    Vector, "DBC File Format Documentation", 1.0.5.
    """
    nodes = dict.fromkeys(name for pair in receivers.items() for name in pair)
    lines = ['VERSION ""', "", "NS_ :", "", "BS_:", "", f"BU_: {' '.join(map(str.capitalize, nodes))}", ""]
    for layout in layouts:
        lines += [*_message(layout, receivers), ""]
    lines += [f'CM_ BO_ {layout.identifier} "{layout.purpose}";' for layout in layouts]
    lines += [
        'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","reserved","reserved","reserved",'
        '"reserved","reserved","reserved","reserved","reserved","reserved","reserved","reserved",'
        '"StandardCAN_FD","ExtendedCAN_FD";',
        'BA_DEF_ BO_ "CANFD_BRS" ENUM "0","1";',
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;',
        'BA_DEF_ "BusType" STRING;',
        'BA_DEF_DEF_ "VFrameFormat" "StandardCAN";',
        'BA_DEF_DEF_ "CANFD_BRS" "0";',
        'BA_DEF_DEF_ "GenMsgCycleTime" 0;',
        'BA_DEF_DEF_ "BusType" "CAN";',
        'BA_ "BusType" "CAN FD";',
    ]
    for layout in layouts:
        lines += _attributes(layout)
    lines += [text for layout in layouts for text in _choices(layout)]
    return "\n".join([*lines, ""])


def _message(layout: Layout, receivers: Mapping[str, str]) -> Iterator[str]:
    receiver = receivers[layout.sender].capitalize()
    yield f"BO_ {layout.identifier} {layout.name}: {layout.size} {layout.sender.capitalize()}"
    start = 0
    for field in layout.fields:
        yield _signal(field, start, receiver)
        start += field.bits
    bits = layout.modulus.bit_length() - 1
    end = 8 * layout.size
    for name, place in (("counter", end - 2 * bits), ("checksum", end - bits)):
        yield f' SG_ {name} : {place}|{bits}@1+ (1,0) [0|{layout.modulus - 1}] "" {receiver}'


def _signal(field: Field, start: int, receiver: str) -> str:
    signed = field.kind.islower()
    low, high = (-1 << field.bits - 1, (1 << field.bits - 1) - 1) if signed else (0, (1 << field.bits) - 1)
    bounds = f"[{low * field.scale:.15g}|{high * field.scale:.20g}]" if signed else f"[{low}|{high}]"
    sign = "-" if signed else "+"
    return f' SG_ {field.name} : {start}|{field.bits}@1{sign} ({field.scale:g},0) {bounds} "{field.unit}" {receiver}'


def _attributes(layout: Layout) -> Iterator[str]:
    frame = _FD_FRAME if layout.is_fd else _CLASSIC_FRAME
    yield f'BA_ "VFrameFormat" BO_ {layout.identifier} {frame};'
    yield f'BA_ "CANFD_BRS" BO_ {layout.identifier} {int(layout.is_fd)};'
    if math.isfinite(layout.period):
        yield f'BA_ "GenMsgCycleTime" BO_ {layout.identifier} {round(1000 * layout.period)};'


def _choices(layout: Layout) -> Iterator[str]:
    for field in layout.fields:
        if field.choices is not None:
            named = " ".join(f'{int(choice)} "{choice.name}"' for choice in field.choices)
            yield f"VAL_ {layout.identifier} {field.name} {named} ;"

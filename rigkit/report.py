"""A report: facts, tables and figures on one self-contained HTML page, and the figures as PNG files."""

import base64
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from matplotlib import rc_context
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from rigkit import atomic
from rigkit.figure_style import styled

MOST_POINTS = 10_000
"""Up to so many points a figure of lines goes in as SVG, sharp at any size; a denser one, or an image, as PNG."""


@dataclass(frozen=True)
class Fact:
    """One figure that a reader looks for first.

    Parameters
    ----------
    label, value : str
        What it is, and the value with its unit.
    passed : bool or None
        Whether it meets its limit; None where it has none.
    """

    label: str
    value: str
    passed: bool | None = None


@dataclass(frozen=True)
class Table:
    """Rows of text under a head; the first column says what a row is, the others are figures."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Plot:
    """A figure, and what to see in it: shown below, and read out to those who cannot see it."""

    figure: Figure
    caption: str


@dataclass(frozen=True)
class Section:
    """A part of a report under a title of its own; a blank line in `text` begins a paragraph."""

    title: str
    text: str = ""
    plots: tuple[Plot, ...] = ()
    tables: tuple[Table, ...] = ()


@dataclass(frozen=True)
class Report:
    """All that a report shows, in the order in which it shows it.

    Parameters
    ----------
    title, subtitle : str
    facts : tuple of Fact
    sections : tuple of Section
        Their titles name the PNG files, so no two are alike.
    """

    title: str
    subtitle: str
    facts: tuple[Fact, ...]
    sections: tuple[Section, ...]

    def __post_init__(self) -> None:
        """Refuse two sections of one name, and a row that does not fit under its head."""
        names = [_file_name(section.title) for section in self.sections]
        if len(set(names)) != len(names):
            raise ValueError(f"the sections are called {names}, must differ")
        for table in (table for section in self.sections for table in section.tables):
            for row in table.rows:
                if len(row) != len(table.head):
                    raise ValueError(f"a row has {len(row)} cells, must be {len(table.head)}: {row}")

    def html(self) -> str:
        """Write the page: one HTML file that needs no other and loads nothing."""
        page = jinja2.Environment(
            autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
        )
        page.filters |= {"image": _image, "anchor": _file_name, "paragraphs": _paragraphs, "is_prose": _is_prose}
        template = files("rigkit").joinpath("report_page.html").read_text(encoding="utf-8")
        return page.from_string(template).render(report=self)

    def write(self, path: str | Path) -> None:
        """Write the page to a file in one step."""
        atomic.write(path, self.html())

    def png(self, folder: str | Path) -> list[Path]:
        """Write every figure as a PNG file named by its section, and return the files; makes the folder."""
        with atomic.folder(Path(folder)) as place:
            written = []
            for name, plot in self._named_plots():
                written.append(place / f"{name}.png")
                atomic.write(written[-1], _rendered(plot.figure, "png"))
        return written

    def _named_plots(self) -> Iterator[tuple[str, Plot]]:
        for section in self.sections:
            name = _file_name(section.title)
            for number, plot in enumerate(section.plots, start=1):
                yield (name if len(section.plots) == 1 else f"{name}-{number}"), plot


def _file_name(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower()).strip("-")


def _is_prose(cell: str) -> bool:
    """Whether a cell has more than two words that are no numbers: a sentence, which stands left and is wrapped."""
    return sum(not _is_number(word.strip("(),;%±")) for word in cell.split()) > 2


def _is_number(word: str) -> bool:
    try:
        return not word or isinstance(float(word), float)
    except ValueError:
        return False


def _paragraphs(text: str) -> list[str]:
    return [paragraph for paragraph in re.split(r"\n\s*\n", text.strip()) if paragraph]


def _image(figure: Figure) -> str:
    points = sum(np.size(line.get_xdata()) for axes in figure.axes for line in axes.lines)
    images = any(axes.images or any(isinstance(each, QuadMesh) for each in axes.collections) for axes in figure.axes)
    kind, mime = ("png", "png") if images or points > MOST_POINTS else ("svg", "svg+xml")
    return f"data:image/{mime};base64,{base64.b64encode(_rendered(figure, kind)).decode()}"


def _rendered(figure: Figure, kind: str) -> bytes:
    content = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}  # the same figure gives the same bytes
    with styled():
        lay_out(figure)
        figure.savefig(content, format=kind, metadata=metadata)
    return content.getvalue()


def lay_out(figure: Figure) -> None:
    """Lay a figure out once, however often it is rendered: `savefig` would draw it once more each time to do so."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
        with rc_context({"figure.constrained_layout.use": False}):
            figure.set_layout_engine(None)

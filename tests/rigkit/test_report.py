"""The report: one page that needs no other, and its figures as files."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS, LIMIT, styled
from rigkit.report import MOST_POINTS, Fact, Plot, Report, Section, Table

PNG = b"\x89PNG\r\n\x1a\n"


@styled()
def figure(points: int = 10) -> Figure:
    drawn = Figure()
    axes = drawn.subplots()
    axes.plot(np.random.default_rng(1).standard_normal(points))
    axes.axhline(0.0, **LIMIT)
    axes.set_xlabel("time, s")
    return drawn


def report(*sections: Section, title: str = "A run") -> Report:
    return Report(
        title, "simulated", (Fact("IAE", "68"), Fact("worst", "-3 dB", True), Fact("THD", "9", False)), sections
    )


def tags(html: str) -> list[tuple[str, dict[str, str | None]]]:
    found: list[tuple[str, dict[str, str | None]]] = []
    parser = HTMLParser()
    parser.handle_starttag = lambda tag, attributes: found.append((tag, dict(attributes)))  # type: ignore[method-assign]
    parser.feed(html)
    return found


def test_the_page_shows_facts_sections_tables_and_figures() -> None:
    table = Table(("shot", "IAE"), (("0", "68.1"), ("1", "50.2")))
    html = report(Section("Spectra", "First.\n\nSecond.", (Plot(figure(), "All of them."),), (table,))).html()
    for piece in ("<h1>A run</h1>", "<p>First.</p>", "<p>Second.</p>", "<td>68.1</td>", "<h2>Spectra</h2>", "✓ pass",
                  "✗ fail", 'alt="All of them."', "<figcaption>All of them.</figcaption>"):  # fmt: skip
        assert piece in html


def test_numbers_however_they_are_written_stand_right_and_sentences_left() -> None:
    figures = ("68.1", "1e-09", "-1.2e-09", "3.1 ± 0.2 %", "129 of 205", "nan", "-", "0.4 (0.1 to 0.9)")
    sentences = ("no loop keeps its bounds", "held: 3 V is over")
    table = Table(("case", "value"), tuple(("a row", text) for text in (*figures, *sentences)))
    html = report(Section("Values", tables=(table,))).html()
    assert [text for text in figures if f"<td>{text}</td>" not in html] == []
    assert [text for text in sentences if f'<td class="prose">{text}</td>' not in html] == []


def test_the_page_loads_nothing_from_elsewhere() -> None:
    html = report(Section("Spectra", "", (Plot(figure(), "x"), Plot(figure(MOST_POINTS + 1), "y")))).html()
    for tag, attributes in tags(html):
        assert tag not in {"script", "link", "iframe", "object"}
        for name in ("src", "href"):
            assert (attributes.get(name) or "data:").startswith(("data:", "#"))
    assert "url(" not in html
    assert "default-src 'none'" in html


def test_text_is_never_taken_for_markup() -> None:
    evil = "<script>alert('x')</script>"
    table = Table((evil,), ((evil,),))
    html = Report(evil, evil, (Fact(evil, evil),), (Section(evil, evil, (Plot(figure(), evil),), (table,)),)).html()
    assert "<script" not in html
    assert html.count("&lt;script&gt;") >= 8


def test_lines_are_sharp_and_what_is_dense_or_an_image_is_small() -> None:
    with styled():
        image = Figure()
        image.subplots().pcolormesh(np.zeros((20, 20)))
    plots = tuple(Plot(drawn, "x") for drawn in (figure(MOST_POINTS - 2), figure(MOST_POINTS + 1), image))
    html = report(Section("Spectra", "", plots)).html()
    images = re.findall(r'src="data:image/([a-z+]+);base64,([^"]+)"', html)
    assert [kind for kind, _ in images] == ["svg+xml", "png", "png"]
    assert max(len(content) for _, content in images) < 400_000


def test_the_same_figures_give_the_same_page() -> None:
    pages = {report(Section("Spectra", "", (Plot(figure(), "x"),))).html() for _ in range(2)}
    assert len(pages) == 1


def test_figures_are_written_as_png_named_by_their_section(tmp_path: Path) -> None:
    one, two = Section("Drives, V", "", (Plot(figure(), "x"),)), Section("IAE", "", (Plot(figure(), ""),) * 2)
    written = report(one, two).png(tmp_path / "png")
    assert [path.name for path in written] == ["drives-v.png", "iae-1.png", "iae-2.png"]
    assert sorted(tmp_path.joinpath("png").iterdir()) == sorted(written)
    assert all(path.read_bytes().startswith(PNG) for path in written)


def test_the_page_is_written_whole(tmp_path: Path) -> None:
    page = report(Section("Spectra"))
    page.write(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page.html()


def test_two_sections_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match=r"\['drives', 'drives'\], must differ"):
        report(Section("Drives"), Section("drives?"))


def test_a_row_that_does_not_fit_under_its_head_is_refused() -> None:
    with pytest.raises(ValueError, match="a row has 1 cells, must be 2"):
        report(Section("Shots", tables=(Table(("shot", "IAE"), (("0",),)),)))


def test_the_style_ends_with_the_block() -> None:
    with styled():
        inside = Figure().subplots().plot([1, 2])[0].get_color()
    outside = Figure().subplots().plot([1, 2])[0].get_color()
    assert inside == COLOURS[0]
    assert outside != COLOURS[0]

"""The site: the pages of docs/, four tutorials, a gallery that is run, and references made from the code.

`make site` builds it into build/site/; a warning fails it.
"""

import shutil
import sys
import warnings
from importlib import metadata
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE)]

import pages  # noqa: E402 (it stands beside this file)

project, author, copyright = "vibrostage", "the vibrostage developers", "the vibrostage developers"  # noqa: A001
release = version = metadata.version("vibrostage")
extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
html_theme = "pydata_sphinx_theme"
html_title = f"vibrostage {release}"
html_theme_options = {"navigation_with_keys": False, "show_nav_level": 1, "footer_start": ["copyright"]}
html_show_sourcelink = False
exclude_patterns = ["**/README.md"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4
autodoc_typehints = "none"
autosummary_generate = True
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
suppress_warnings = ["config.cache", "myst.header"]
sphinx_gallery_conf = {
    "examples_dirs": str(ROOT / "examples" / "gallery"),
    "gallery_dirs": "gallery",
    "filename_pattern": r"/plot_",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "capture_repr": (),
    "min_reported_time": 1e9,
}

warnings.filterwarnings("ignore", "Unknown section", UserWarning)  # renamed below, as far as they are shown
pages.write(HERE, ROOT)
shutil.rmtree(HERE / "api", ignore_errors=True)


def _as_numpydoc(*given: Any) -> None:
    """Give sections of the project's own the names that numpydoc knows, and take bars as they are."""
    lines: list[str] = given[-1]
    for number, line in enumerate(lines):
        if line in ("Source", "Departs") and number + 1 < len(lines) and set(lines[number + 1]) == {"-"}:
            lines[number] = {"Source": "References", "Departs": "Notes"}[line]
            lines[number + 1] = "-" * len(lines[number])
        elif not line.lstrip().startswith(">>>"):
            lines[number] = line.replace("|", r"\|")


def setup(app: Any) -> None:
    """Connect it ahead of numpydoc."""
    app.connect("autodoc-process-docstring", _as_numpydoc, priority=1)

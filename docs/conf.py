# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the site of these pages. docs/build.py runs Doxygen and Sphinx with it."""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[1]
# The package of a build, by PYTHONPATH or from ./quickstart build.
sys.path += map(str, root.glob("build/release/lib/python3*/site-packages"))

project = "MammoRay"
author = "MammoRay maintainers"
project_copyright = "MammoRay maintainers, Apache-2.0"
version = release = re.search(r"^project\(MammoRay VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)
extensions = ["myst_parser", "sphinx.ext.autodoc", "breathe"]
exclude_patterns = ["pictures"]
root_doc = "index"
language = "en"
smartquotes = False  # -- begins an option

myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4

breathe_default_project = "MammoRay"
# Overwritten by docs/build.py, which knows where Doxygen has written.
breathe_projects = {"MammoRay": "doxygen/xml"}



def keep_layout(app, what, name, thing, options, lines):
    """Docstrings are plain text in columns: behind their first paragraph they stay as they are."""
    rest = lines[lines.index(""):] if "" in lines else []
    first = " ".join(line.strip() for line in lines[:len(lines) - len(rest)])
    lines[:] = [first, ""]
    if any(line.strip() for line in rest):
        lines += [".. code-block:: text", ""] + ["   " + line for line in rest] + [""]


def setup(app):
    app.connect("autodoc-process-docstring", keep_layout)


autodoc_typehints = "none"
autodoc_member_order = "bysource"

html_theme = "furo"
html_title = f"MammoRay {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False

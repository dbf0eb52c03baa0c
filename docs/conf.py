# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the site of these pages. docs/build.py runs Doxygen and Sphinx with it."""
import pathlib
import re
import sys

from docutils import nodes

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


GLOSSARY = "reference/glossary"
TERMS = re.findall(r"^(\S.*)\n: ", (root / f"docs/{GLOSSARY}.md").read_text(), re.MULTILINE)


def id_of(term):
    return "term-" + re.sub(r"\W+", "-", term.lower())


def link_terms(app, doctree, page):
    """Links the first mention of each term of the glossary on a page of prose."""
    if page == GLOSSARY:
        for term in doctree.findall(nodes.term):
            term["ids"].append(id_of(term.astext()))
    if page.startswith("reference/") or page.startswith("develop/"):
        return
    words = {word.strip(): id_of(term) for term in TERMS for word in term.split(",")}
    for text in list(doctree.findall(nodes.Text)):
        if isinstance(text.parent, (nodes.paragraph, nodes.emphasis, nodes.strong)):
            found = min(filter(None, (re.search(rf"\b{re.escape(word)}\b", text, re.IGNORECASE) for word in words)), key=lambda one: one.start(),
                        default=None)
            if found:
                name = next(word for word in words if word.lower() == found[0].lower())
                link = nodes.reference("", found[0], refuri=f"{app.builder.get_relative_uri(page, GLOSSARY)}#{words[name]}", classes=["glossary"])
                text.parent.replace(text, [nodes.Text(text[:found.start()]), link, nodes.Text(text[found.end():])])
                words = {word: place for word, place in words.items() if place != words[name]}


def keep_layout(app, what, name, thing, options, lines):
    """Docstrings are plain text in columns: behind their first paragraph they stay as they are."""
    rest = lines[lines.index(""):] if "" in lines else []
    first = " ".join(line.strip() for line in lines[:len(lines) - len(rest)])
    lines[:] = [first, ""]
    if any(line.strip() for line in rest):
        lines += [".. code-block:: text", ""] + ["   " + line for line in rest] + [""]


def setup(app):
    app.connect("autodoc-process-docstring", keep_layout)
    app.connect("doctree-resolved", link_terms)


autodoc_typehints = "none"
autodoc_member_order = "bysource"

html_theme = "furo"
html_title = f"MammoRay {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False

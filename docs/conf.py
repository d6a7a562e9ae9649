"""Sphinx reads the Markdown pages beside this file; `sphinx-build -W docs docs/_build` makes the site."""

from importlib.metadata import version as installed_version

project = "rainwind"
author = "The rainwind developers"
release = version = installed_version("rainwind")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
# several decisions and pages link to files outside docs/ that are read on the repository's own site
suppress_warnings = ["myst.xref_missing"]
exclude_patterns = ["_build"]

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_format = "short"

html_theme = "furo"
html_title = f"rainwind {release}"


def setup(app):
    """Read docstrings as plain words: |F| is a norm in them, no substitution."""

    def escape(app, what, name, obj, options, lines):
        lines[:] = [line.replace("|", "\\|") for line in lines]

    app.connect("autodoc-process-docstring", escape)

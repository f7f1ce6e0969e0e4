# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Sphinx configuration: ``python -m sphinx -W --keep-going -b html doc build/doc``.

The reference pages are generated from the code by ``_extensions/generated_reference.py``, so the package must be importable.
"""

import re
import sys
from importlib.util import find_spec
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
if not (FOLDER / "_extensions").is_dir():  # rosdoc2 executes this file from a conf.py of its own, in another folder
    FOLDER = Path(re.search(r'exec\(open\("(.+?)"\)', Path(__file__).read_text())[1]).resolve().parent
ROOT = FOLDER.parent
sys.path[:0] = [str(ROOT), str(FOLDER / "_extensions")]

project = "bearing_sim"
author = "bearing_sim maintainers"
copyright = "2026, bearing_sim maintainers"
release = version = next(line.split('"')[1] for line in (ROOT / "setup.py").read_text().splitlines() if line.strip().startswith("version="))

# The build farm of ROS has Sphinx and MyST alone: there the pages are built without what only their look needs.
complete = all(find_spec(name) for name in ("math_core", "pydata_sphinx_theme", "sphinx_design"))
looks = ["sphinx_design", "mathml"] if complete else ["sphinx.ext.mathjax"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "generated_reference", "notebook_pages", *looks]
html_math_renderer = "mathml" if complete else "mathjax"
exclude_patterns = ["_build", "modules.rst", "bearing_sim*.rst"]  # the latter two are made by rosdoc2; reference/ has them

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist", "fieldlist"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

# In docstrings, `name` refers to an object where Sphinx knows it, and is plain code where it does not.
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_typehints = "none"

html_title = "bearing_sim"
html_theme = "pydata_sphinx_theme" if complete else "alabaster"
if complete:
    html_theme_options = {
        "header_links_before_dropdown": 5,
        "navbar_end": ["theme-switcher"],
        "show_toc_level": 2,
        "footer_start": ["copyright"],
        "footer_end": [],
    }
html_sidebars = {"index": []} if complete else {}
html_show_sourcelink = False
html_static_path = [str(FOLDER / "_static")]
html_css_files = ["pages.css"]
html_copy_source = False

# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings; scripts/docs calls it on the folder that assemble.py lays out."""

from __future__ import annotations

import sys
from pathlib import Path

import sepcal

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
sys.path.insert(0, str(SITE))

project = "sepcal"
author = "sepcal authors"
copyright = author
version = release = sepcal.__version__
extensions = [
    "breathe",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "extension",
]
include_patterns = ["*.md", "api/**", "notebooks/*"]

myst_heading_anchors = 4  # as GitHub has them
myst_fence_as_directive = ["math"]
html_math_renderer = "mathml"

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300  # [s] a cell

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
python_use_unqualified_type_names = True
napoleon_numpy_docstring = False
napoleon_custom_sections = [("A class may also have", "params_style")]
napoleon_use_param = napoleon_use_rtype = False  # shapes and words, not types to link
toc_object_entries_show_parents = "hide"
add_module_names = False

breathe_projects = {"sepcal": str(ROOT / "build-docs" / "doxygen" / "xml")}
breathe_default_project = "sepcal"
breathe_default_members = ("members", "undoc-members")

suppress_warnings = ["duplicate_declaration.cpp"]  # each header opens namespace sepcal

html_theme = "furo"
html_title = f"sepcal {version}"
html_static_path = [str(SITE / "static")]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False

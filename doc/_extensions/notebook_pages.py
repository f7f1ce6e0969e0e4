# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Jupyter notebooks as pages: their text and code, without outputs, which depend on the machine that executes them."""

import json
from pathlib import Path

from myst_parser.parsers.sphinx_ import MystParser

SUFFIX, FILE_TYPE = ".ipynb", "notebook"


def markdown_of(notebook: dict, name: str) -> str:
    """Return a notebook as Markdown, with a link to its file below the heading that it begins with.

    Parameters
    ----------
    notebook : as read from its JSON.
    name : of its file.
    """
    parts = []
    for cell in notebook["cells"]:
        text = "".join(cell["source"])
        parts.append(f"```python\n{text}\n```" if cell["cell_type"] == "code" else text)
    heading, _, rest = parts[0].partition("\n")
    link = f"This page is a Jupyter notebook: {{download}}`{name} <{name}>`. Its outputs appear where you execute it."
    return "\n\n".join([heading, link, rest.strip(), *parts[1:]])


class NotebookParser(MystParser):
    """Parser of notebooks."""

    supported = (FILE_TYPE,)

    def parse(self, inputstring: str, document) -> None:
        """Parse the JSON of a notebook into a document; see the base class."""
        super().parse(markdown_of(json.loads(inputstring), Path(document["source"]).name), document)


def setup(app):
    """Register notebooks as source files."""
    app.add_source_suffix(SUFFIX, FILE_TYPE)
    app.add_source_parser(NotebookParser)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

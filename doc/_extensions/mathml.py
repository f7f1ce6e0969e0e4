# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Sphinx extension that converts equations to MathML when the pages are built: browsers draw it without a script and without a network.

An equation that cannot be converted is a warning of the build, with the page and the reason.
"""

from docutils import nodes
from math_core import LatexError, LatexToMathML
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

CONVERTER = LatexToMathML(fancy_error=False)
_LOGGER = logging.getLogger(__name__)


def mathml_of(node: nodes.Element, displaystyle: bool) -> str:
    """Return the MathML of an equation, or its LaTeX as code where the equation cannot be converted."""
    latex = node.astext()
    try:
        return CONVERTER.convert_with_local_state(latex, displaystyle=displaystyle)
    except LatexError as error:
        _LOGGER.warning("cannot convert the equation %r to MathML: %s", latex, error, location=node, type="mathml")
        return f"<code>{nodes.unescape(latex)}</code>"


def visit_inline(translator, node: nodes.math) -> None:
    """Write an equation within a line."""
    translator.body.append(translator.starttag(node, "span", "", CLASS="math notranslate nohighlight") + mathml_of(node, False) + "</span>")
    raise nodes.SkipNode


def visit_display(translator, node: nodes.math_block) -> None:
    """Write an equation of its own, with its number and a link to it where it has a label."""
    translator.body.append(translator.starttag(node, "div", CLASS="math notranslate nohighlight"))
    if node["number"]:
        translator.body.append(f'<span class="eqno">({get_node_equation_number(translator, node)})')
        translator.add_permalink_ref(node, "Link to this equation")
        translator.body.append("</span>")
    translator.body.append(mathml_of(node, True) + "</div>\n")
    raise nodes.SkipNode


def setup(app):
    """Register the renderer; ``html_math_renderer = "mathml"`` chooses it."""
    app.add_html_math_renderer("mathml", inline_renderers=(visit_inline, None), block_renderers=(visit_display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}

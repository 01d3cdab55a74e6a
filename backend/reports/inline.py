"""A drawing as a part of a page."""

import re
from html import escape


def inline_svg(svg: bytes, name: str, caption: str) -> str:
    """Return an SVG for a page with others: without its head, with ids of its own, named for those who do not see it."""
    text = svg.decode("utf-8")
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    for before, after in (('id="', '"'), ('href="#', '"'), ("url(#", ")")):
        text = re.sub(f"({re.escape(before)})([^\"')]+)({re.escape(after)})", rf"\g<1>{name}-\2\3", text)
    label = escape(caption, quote=True)
    return re.sub(
        r'<svg ([^>]*?)width="[^"]*"([^>]*?)height="[^"]*"',
        rf'<svg role="img" aria-label="{label}" \1\2',
        text,
        count=1,
    )

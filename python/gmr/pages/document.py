"""Pieces of HTML. Every text that comes from outside goes through :func:`text`, and is no markup after it."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any

__all__ = ["attributes", "element", "items", "json_text", "own", "script_hash", "section", "text"]


def own(package: str, name: str) -> str:
    """A file that ships in a package, beside its modules."""
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")


def text(value: object) -> str:
    """A text as it stands in HTML, also inside of an attribute's quotes."""
    return html.escape(str(value), quote=True)


def attributes(values: Mapping[str, object]) -> str:
    """Attributes of a tag, each after a blank; True stands alone, None and False are left out."""
    return "".join(
        f" {name}" if value is True else f' {name}="{text(value)}"'
        for name, value in values.items()
        if value is not None and value is not False
    )


def element(tag: str, content: str, **values: object) -> str:
    """An element around HTML. Underscores at the end of an attribute are dropped, others become hyphens."""
    named = {name.rstrip("_").replace("_", "-"): value for name, value in values.items()}
    return f"<{tag}{attributes(named)}>{content}</{tag}>"


def items(values: Iterable[object]) -> str:
    """List items of plain texts."""
    return "".join(element("li", text(value)) for value in values)


def section(name: str, title: str, lead: str, content: str) -> str:
    """A section of a page: its heading, a line below it where there is one, and HTML."""
    head = element("h2", text(title)) + (element("p", text(lead), class_="lead") if lead else "")
    return element("section", head + content, id=name)


def json_text(value: Any) -> str:
    """JSON that no HTML parser can take for a tag, a comment or the end of the script that holds it."""
    plain = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for sign in "<>&\u2028\u2029":
        plain = plain.replace(sign, f"\\u{ord(sign):04x}")
    return plain


def script_hash(script: str) -> str:
    """The script as a Content-Security-Policy names it: only scripts so named may run in the page."""
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return f"'sha256-{digest}'"

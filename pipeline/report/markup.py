"""Elements of a page as text.  Every text and every attribute is escaped: no name is ever read as markup."""

from dataclasses import dataclass
from html import escape

EMPTY = frozenset({"rect", "path", "line", "circle", "input"})
"""Elements written without a text of their own."""


@dataclass(frozen=True, slots=True)
class Element:
    """An element as it is written."""

    text: str


Child = Element | str | None


def element(tag: str, *children: Child, **attributes: object) -> Element:
    """Return an element; `cls` stands for class, underscores for dashes.

    Children that are texts are escaped; those that are None are left out, and so are attributes that are None or False.
    """
    told = "".join(_attribute(name, value) for name, value in attributes.items() if value not in (None, False))
    inner = "".join(_written(child) for child in children if child is not None)
    end = "" if tag in EMPTY else f"{inner}</{tag}>"
    return Element(f"<{tag}{told}{'/' if tag in EMPTY else ''}>{end}")


def _written(child: Element | str) -> str:
    return child.text if isinstance(child, Element) else escape(child)


def _attribute(name: str, value: object) -> str:
    key = "class" if name == "cls" else name.rstrip("_").replace("_", "-")
    return f" {key}" if value is True else f' {key}="{escape(str(value))}"'


def shown(value: object, unit: str = "") -> str:
    """Return a number with five digits as a person reads it, with its unit; a dash for what is not known."""
    if value is None:
        return "\u2013"
    if isinstance(value, bool):
        return "yes" if value else "no"
    text = str(value) if isinstance(value, int) else f"{value:.5g}"
    spelt = {"deg": "\u00b0", "mm2": "mm\u00b2"}.get(unit, unit)
    return text.replace("-", "\u2212") + (f"\u00a0{spelt}" if spelt else "")


def percent(share: float) -> str:
    """Return a share in percent with three digits; what is not all is not shown as all."""
    told = f"{100.0 * share:.3g}"
    return f"{'99.9' if told == '100' and share < 1.0 else told}\u00a0%"

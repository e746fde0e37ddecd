"""HTML tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def table_html(columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """Returns an HTML table with escaped cells."""

    def cells(tag: str, values: Sequence[object]) -> str:
        return "".join(f"<{tag} style='text-align: left'>{escape(str(value))}</{tag}>" for value in values)

    head = f"<caption>{escape(caption)}</caption>" if caption else ""
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table>{head}<thead><tr>{cells('th', columns)}</tr></thead><tbody>{body}</tbody></table>"


def pairs_html(title: str, pairs: Iterable[tuple[str, object]]) -> str:
    """Returns an HTML table of names and values."""
    return table_html([title, ""], [list(pair) for pair in pairs])

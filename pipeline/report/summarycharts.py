"""Charts of the summary as drawings within the page: bars beside their counts, and trends over the jobs.

Every chart has its numbers as text beside it or in the title of its marks; colours only repeat what position says.
"""

from collections.abc import Mapping, Sequence

from pipeline.report.markup import Element, element, percent, shown

Row = Mapping[str, object]
WIDE, HIGH, LEFT, FOOT = 420.0, 150.0, 52.0, 22.0
"""Of a chart, in its own units: the whole, and what axis numbers take on the left and below."""
TOP = 10.0
BOX = f"0 0 {WIDE:g} {HIGH:g}"
BAR = 100.0
"""Length of a full bar in its own units."""
TRENDS = (
    ("share_made", "Share of jobs made", 1.0),
    ("largest_load", "Largest value over its limit", 1.0),
    ("mean_utilisation", "Mean utilisation of sheets", 1.0),
    ("mean_seconds", "Mean seconds a job", None),
)
"""What is drawn: its name, its title, and the value that its axis reaches at least."""
PERCENT = frozenset({"share_made", "mean_utilisation"})


def bars(rows: Sequence[Row], name: str) -> Element:
    """Return counts with bars as a table; causes have the share of all up to them, and a job as example."""
    cumulative = any("cumulative" in row for row in rows)
    heads = [name.capitalize(), "Jobs", "Share", "", *(["Up to here", "For example"] if cumulative else [])]
    most = max((float(str(row["share"])) for row in rows), default=1.0)
    body = (_bar_row(row, name, most, cumulative=cumulative) for row in rows)
    head = element("thead", element("tr", *map(heading, heads)))
    caption = element("caption", f"Jobs by {name}", cls="unseen")
    return element("div", element("table", caption, head, element("tbody", *body), cls="bars"), cls="scroll")


FIGURES = frozenset({"Jobs", "Share", "Up to here", "Value", "Limit", "Load", "Parts", "Failed", "Seconds"})
"""Headings of columns of numbers."""


def heading(text: str) -> Element:
    """Return the heading of a column; numbers stand on the right."""
    return element("th", text, scope="col", cls="n" if text in FIGURES else None)


def _bar_row(row: Row, name: str, most: float, *, cumulative: bool) -> Element:
    share = float(str(row["share"]))
    good = row[name] == "made"
    bar = element("rect", x=0, y=0, height=10, width=f"{BAR * share / most:.3f}", cls="good" if good else "bad")
    drawn = element("svg", bar, viewBox=f"0 0 {BAR:g} 10", preserveAspectRatio="none", aria_hidden="true", cls="bar")
    cells = [element("td", str(row[name])), _number(shown(row["jobs"])), _number(percent(share)), element("td", drawn)]
    if cumulative:
        cells += [_number(percent(float(str(row["cumulative"])))), element("td", str(row["example"]))]
    return element("tr", *cells)


def _number(text: str) -> Element:
    return element("td", text, cls="n")


def charts(trend: Sequence[Row]) -> Element:
    """Return the trends that there are numbers for, a chart each."""
    known = [(key, title, least) for key, title, least in TRENDS if any(row[key] is not None for row in trend)]
    return element("div", *(chart(trend, key, title, least) for key, title, least in known), cls="charts")


def chart(trend: Sequence[Row], key: str, title: str, least: float | None) -> Element:
    """Return a trend: a bar for each group of jobs, from 0; least: what the axis reaches at least."""
    values = [None if row[key] is None else float(str(row[key])) for row in trend]
    top = max([value for value in values if value is not None] + ([least] if least else [1e-9]))
    step = (WIDE - LEFT) / len(values)
    marks = [
        _mark(row, told(key, value), LEFT + i * step, step, value / top)
        for i, (row, value) in enumerate(zip(trend, values, strict=True))
        if value is not None
    ]
    limit = _rule(1.0 / top, "limit") if key == "largest_load" else None
    rise = [_label(told(key, top), LEFT - 4, TOP + 4, "end"), _label("0", LEFT - 4, HIGH - FOOT, "end")]
    first, last = _short(trend[0]["first"]), _short(trend[-1]["last"])
    along = [_label(first, LEFT, HIGH - 6, "start"), _label("" if first == last else last, WIDE, HIGH - 6, "end")]
    drawn = element(
        "svg",
        *marks,
        limit,
        _rule(0.0, "axis"),
        *rise,
        *along,
        viewBox=f"0 0 {WIDE:g} {HIGH:g}",
        role="img",
        aria_label=title,
    )
    note = element("figcaption", f"{title}{' (line: the limit)' if limit else ''}")
    return element("figure", note, drawn)


def told(key: str, value: float) -> str:
    """Return a value of a trend as it is read."""
    return percent(value) if key in PERCENT else f"{value:.3g}"


def _mark(row: Row, text: str, x: float, wide: float, share: float) -> Element:
    """Return the bar of a group of jobs; its title names them."""
    high = (HIGH - FOOT - TOP) * share
    of = f"{row['first']}" if row["jobs"] == 1 else f"{row['first']} to {row['last']} ({row['jobs']} jobs)"
    gap = min(1.0, 0.2 * wide)
    shape = {"x": f"{x:.2f}", "y": f"{HIGH - FOOT - high:.2f}", "width": f"{wide - gap:.2f}", "height": f"{high:.2f}"}
    return element("g", element("title", f"{of}: {text}"), element("rect", **shape), cls="mark")


def _rule(share: float, cls: str) -> Element:
    y = HIGH - FOOT - (HIGH - FOOT - TOP) * share
    return element("line", x1=LEFT, x2=WIDE, y1=f"{y:.2f}", y2=f"{y:.2f}", cls=cls)


def _label(text: str, x: float, y: float, anchor: str) -> Element:
    return element("text", text, x=x, y=y, text_anchor=anchor)


LONGEST = 24
"""Characters of the name of a job below a chart."""


def _short(name: object) -> str:
    text = str(name)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}\u2026"

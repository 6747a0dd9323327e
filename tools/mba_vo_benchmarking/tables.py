"""Tables that can be written as Markdown and as HTML."""
import dataclasses
import html


@dataclasses.dataclass(frozen=True)
class Table:
    title: str
    note: str  # below the title
    header: list
    rows: list  # of texts; the first columns are names


def markdown(table):
    def line(cells):
        return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"

    lines = ["## " + table.title, ""]
    if table.note:
        lines += [table.note, ""]
    lines += [line(table.header), "|" + "---|" * len(table.header)]
    return "\n".join(lines + [line(row) for row in table.rows]) + "\n"


def as_html(table):
    def cells(row, tag):
        return "".join("<%s>%s</%s>" % (tag, html.escape(str(cell)), tag) for cell in row)

    note = "<p>%s</p>" % html.escape(table.note) if table.note else ""
    rows = "\n".join("<tr>%s</tr>" % cells(row, "td") for row in table.rows)
    return "<h2>%s</h2>%s\n<div class=table><table><thead><tr>%s</tr></thead>\n<tbody>%s</tbody></table></div>\n" % (
        html.escape(table.title), note, cells(table.header, "th"), rows)

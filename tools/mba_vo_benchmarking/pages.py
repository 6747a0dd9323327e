"""One Markdown and one self-contained HTML page."""
import base64
import html

from . import page_tables, tables, worst

STYLE = """
body { font: 15px/1.45 sans-serif; margin: 2em auto; max-width: 75em; padding: 0 1em; color: #222 }
table { border-collapse: collapse; font-size: 13px } .table { overflow-x: auto }
th, td { border-bottom: 1px solid #ddd; padding: .25em .7em; text-align: right; white-space: nowrap }
th { background: #f2f4f7; white-space: normal; vertical-align: bottom } td:first-child, th:first-child { text-align: left }
.plots { display: flex; flex-wrap: wrap; gap: 1em } figure { margin: 0; width: 30em } img { width: 100% }
svg { max-width: 100%; height: auto } pre { background: #f2f4f7; padding: .6em; overflow-x: auto }
"""
MOST_PICTURES = 24
PLOT_NOTE = "Of the starts the one in the middle%s. Grey: the truth; red: published, or another system; blue: smoothed."
FEW_NOTE = ", of %d runs the %d that are worst by the published map ATE"
WORST_NOTE = ("Of the same runs: the first image of the longest stretch without a published pose, else the one that fits its keyframe "
              "worst; as an ideal pinhole camera sees it.")
FILES = ("results.md", "results.html", "ate_against_blur.svg")


def _plots(results):
    """Captions and files of the trajectories' plots."""
    for run in results.shown(MOST_PICTURES):
        yield run.name, run.task.folder / "trajectory.png"


def _plot_note(results):
    count = len(results.shown(None))
    return PLOT_NOTE % (FEW_NOTE % (count, MOST_PICTURES) if count > MOST_PICTURES else "")


def _worst(results):
    """Captions and files of the worst frames."""
    for run in results.shown(MOST_PICTURES):
        file = worst.picture(run.task.folder)
        if file is not None:
            index, why = worst.of_run(run.task.folder)
            yield "%s, image %d: %s" % (run.name, run.start + index, why), file


def _figures(pictures):
    for caption, file in pictures:
        picture = base64.b64encode(file.read_bytes()).decode()
        yield ("<figure><img alt='%s' src='data:image/png;base64,%s'><figcaption>%s</figcaption></figure>\n" %
               (html.escape(caption, quote=True), picture, html.escape(caption)))


def as_markdown(results, command, output, curve):
    parts = ["# %s\n" % results.experiment.title, "    %s\n" % command]
    if curve:
        parts.append("## ATE against blur\n\n![ATE against blur](ate_against_blur.svg)\n")
    parts += [tables.markdown(table) for table in page_tables.all_tables(results)]
    parts.append("## Trajectories\n\n%s\n" % _plot_note(results))
    parts += _links(_plots(results), output)
    pictures = _links(_worst(results), output)
    if pictures:
        parts += ["## Worst frames\n\n%s\n" % WORST_NOTE] + pictures
    return "\n".join(parts)


def _links(pictures, output):
    return ["%s\n\n![%s](%s)\n" % (caption, caption, file.relative_to(output).as_posix()) for caption, file in pictures]


def as_page(results, command, curve):
    """HTML that needs no other file."""
    title = html.escape(results.experiment.title)
    parts = ["<!doctype html>\n<html lang=en><meta charset=utf-8><title>%s</title><style>%s</style>\n<h1>%s</h1>\n<pre>%s</pre>\n" %
             (title, STYLE, title, html.escape(command))]
    if curve:
        parts.append("<h2>ATE against blur</h2>\n%s\n" % curve[curve.index("<svg"):])
    parts += [tables.as_html(table) for table in page_tables.all_tables(results)]
    parts.append("<h2>Trajectories</h2><p>%s</p>\n<div class=plots>\n" % _plot_note(results))
    parts += _figures(_plots(results))
    pictures = list(_figures(_worst(results)))
    if pictures:
        parts += ["</div>\n<h2>Worst frames</h2><p>%s</p>\n<div class=plots>\n" % WORST_NOTE] + pictures
    return "".join(parts) + "</div></html>\n"

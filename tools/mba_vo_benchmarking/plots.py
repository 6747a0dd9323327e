"""ATE against blur as a picture."""
import io
import math

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  # after the choice of the back end

COLOURS = ("#1f5fbf", "#c0392b", "#2e8b57", "#8e44ad", "#b8860b", "#444444")


def ate_against_blur(curves):
    """SVG of medians with quartiles, one line for each variant; the same bytes for the same curves."""
    matplotlib.rcParams["svg.hashsalt"] = "mba_vo"
    figure, axes = pyplot.subplots(figsize=(7.0, 4.0))
    for index, (variant, curve) in enumerate(curves.items()):
        finite = [(blur, quartiles) for blur, quartiles, _ in curve if math.isfinite(quartiles[1])]
        if not finite:
            continue
        blur, colour = [b for b, _ in finite], COLOURS[index % len(COLOURS)]
        top = 10.0 * max(q[1] for _, q in finite)  # where the upper quartile failed
        axes.plot(blur, [q[1] for _, q in finite], "o-", color=colour, label=variant)
        axes.fill_between(blur, [q[0] for _, q in finite], [min(q[2], top) for _, q in finite], color=colour, alpha=0.2,
                          linewidth=0)
    axes.set_yscale("log")
    axes.set_xlim(0.0, 60.0)
    axes.set_xlabel("blur that 90 % of the images stay below [px]")
    axes.set_ylabel("published ATE of 5 s [cm]")
    axes.grid(True, which="both", alpha=0.3)
    if axes.lines:
        axes.legend()
    figure.tight_layout()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    return text.getvalue()

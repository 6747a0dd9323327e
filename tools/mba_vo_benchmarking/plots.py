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
        medians = [quartiles[1] for _, quartiles, _ in curve if math.isfinite(quartiles[1])]
        if not medians:
            continue
        colour = COLOURS[index % len(COLOURS)]
        top = 10.0 * max(medians)  # where the upper quartile failed
        # Where most pieces failed the line has a gap, and a cross above it.
        failed = [blur for blur, quartiles, _ in curve if not math.isfinite(quartiles[1])]
        blur = [blur for blur, _, _ in curve]
        low, median, high = zip(*[[math.nan] * 3 if b in failed else q for b, q, _ in curve])
        axes.plot(blur, median, "o-", color=colour, label=variant)
        axes.fill_between(blur, low, [min(h, top) for h in high], color=colour, alpha=0.2, linewidth=0)
        axes.plot(failed, [0.97] * len(failed), "x", color=colour, transform=axes.get_xaxis_transform(),
                  label=variant + ": failed" if failed else None)
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

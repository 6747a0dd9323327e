"""Published figures of other systems, each with its source."""
import dataclasses

from . import checked_yaml
from .errors import BenchmarkError

FIGURE_KEYS = ("system", "data", "source", "input", "ate_cm", "dropped_percent")


@dataclasses.dataclass(frozen=True)
class PublishedSystem:
    name: str
    data: str  # of what the figures are
    source: str
    input: str  # what the system needs and how fast it is, as the source says
    ate_cm: dict  # sequence -> RMSE [cm], or "fail"
    dropped_percent: dict


def load(file):
    keys = checked_yaml.load(file).mapping(("sources", "figures"))
    if "sources" not in keys or "figures" not in keys:
        raise BenchmarkError("%s: sources and figures: both are needed" % file)
    sources = {name: node.text() for name, node in keys["sources"].mapping().items()}
    return tuple(_system(node, sources) for node in keys["figures"].items("a list of systems"))


def _system(node, sources):
    keys = node.mapping(FIGURE_KEYS)
    for key in ("system", "source", "ate_cm"):
        if key not in keys:
            raise BenchmarkError("%s: %s.%s: missing" % (node.file, node.key, key))
    if keys["source"].text() not in sources:
        raise keys["source"].error("one of the sources: " + ", ".join(sources))
    return PublishedSystem(keys["system"].text(), keys["data"].text() if "data" in keys else "",
                           sources[keys["source"].value], keys["input"].text() if "input" in keys else "",
                           _figures(keys["ate_cm"]), _figures(keys["dropped_percent"]) if "dropped_percent" in keys else {})


def _figures(node):
    return {name: "fail" if value.value == "fail" else value.number(0, "a number, 0 or more, or fail")
            for name, value in node.mapping().items()}

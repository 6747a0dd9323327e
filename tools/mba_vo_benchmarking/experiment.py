"""What an experiment file says: sequences, variants, starts, other systems, published figures."""
import dataclasses
import pathlib

from . import checked_yaml, published
from .errors import BenchmarkError

KEYS = ("title", "data", "options", "starts", "time_limit", "sequences", "variants", "others", "published")
SEQUENCE_KEYS = ("path", "groundtruth", "evaluation", "options", "config", "published", "group")
VARIANT_KEYS = ("options", "config")
OURS = ("--output", "--config", "--skip", "--print-config")  # options that the benchmark sets itself
DEFAULT_TIME_LIMIT = 3600.0  # of a run [s]


@dataclasses.dataclass(frozen=True)
class Sequence:
    name: str
    path: pathlib.Path
    groundtruth: pathlib.Path
    evaluation: tuple  # options of mba_vo_evaluate
    options: tuple  # of mba_vo_offline
    config: dict
    published: str  # its name in the table of published figures
    group: str  # sequences that have something in common, such as the exposure; "": none


@dataclasses.dataclass(frozen=True)
class Variant:
    name: str
    options: tuple
    config: dict


@dataclasses.dataclass(frozen=True)
class Experiment:
    title: str
    options: tuple
    starts: tuple
    time_limit: float  # [s]
    sequences: tuple
    variants: tuple
    others: dict  # system -> {name of a sequence: file of its trajectory}
    published: tuple


def load(file, data=None):
    """Reads an experiment; `data` replaces the folder that its sequences are relative to."""
    folder = pathlib.Path(file).resolve().parent
    root = checked_yaml.load(file)
    keys = root.mapping(KEYS)
    if data is None:
        data = folder / keys["data"].text() if "data" in keys else folder
    if "sequences" not in keys or not keys["sequences"].mapping():
        raise BenchmarkError("%s: sequences: missing; at least one NAME: {path: FOLDER} is needed" % file)
    sequences = tuple(_sequence(name, node, pathlib.Path(data), folder)
                      for name, node in keys["sequences"].mapping().items())
    variants = keys["variants"].mapping() if "variants" in keys else {}
    return Experiment(
        title=keys["title"].text() if "title" in keys else pathlib.Path(file).stem,
        options=_options(keys),
        starts=_starts(keys["starts"]) if "starts" in keys else (0,),
        time_limit=keys["time_limit"].number(1, "at least 1 [s]") if "time_limit" in keys else DEFAULT_TIME_LIMIT,
        sequences=sequences,
        variants=tuple(_variant(name, node, folder) for name, node in variants.items()) or (Variant("mba_vo", (), {}),),
        others=_others(keys["others"], folder, {s.name for s in sequences}) if "others" in keys else {},
        published=published.load(folder / keys["published"].text()) if "published" in keys else ())


def _sequence(name, node, data, folder):
    _check_name(node, name)
    keys = node.mapping(SEQUENCE_KEYS) if not isinstance(node.value, str) else {"path": node}
    if "path" not in keys:
        raise BenchmarkError("%s: %s.path: missing; a folder or a bag is needed" % (node.file, node.key))
    path = data / keys["path"].text()
    truth = data / keys["groundtruth"].text() if "groundtruth" in keys else path
    return Sequence(name, path, truth, tuple(keys["evaluation"].words()) if "evaluation" in keys else (), _options(keys),
                    _config(keys, folder), keys["published"].text() if "published" in keys else name,
                    keys["group"].text() if "group" in keys else "")


def _variant(name, node, folder):
    _check_name(node, name)
    keys = node.mapping(VARIANT_KEYS)
    return Variant(name, _options(keys), _config(keys, folder))


def _check_name(node, name):
    if not name.strip() or name.startswith(".") or "/" in name or "|" in name:
        raise BenchmarkError("%s: %s: '%s': must be a name without '/' and '|' that begins with no '.'" %
                             (node.file, node.key, name))


def _options(keys):
    words = keys["options"].words() if "options" in keys else []
    if words and not words[0].startswith("--"):
        raise keys["options"].error("options that begin with --")
    for word in words:
        if word.split("=")[0] in OURS:
            raise keys["options"].error("without %s, which the benchmark sets itself" % word.split("=")[0])
    return tuple(words)


def _config(keys, folder):
    """Keys of a configuration, written here or in a file of its own."""
    if "config" not in keys:
        return {}
    node = keys["config"]
    if isinstance(node.value, str):
        node = checked_yaml.load(folder / node.value)
    node.mapping()
    return node.value or {}


def _starts(node):
    starts = []
    for item in node.items("a list of images to leave out at the beginning, such as [0, 10, 20]"):
        if not isinstance(item.value, int) or isinstance(item.value, bool) or item.value < 0:
            raise item.error("a number of images, 0 or more")
        if item.value in starts:
            raise item.error("given once")
        starts.append(item.value)
    return tuple(starts)


def _others(node, folder, sequences):
    others = {}
    for system, files in node.mapping().items():
        _check_name(files, system)
        others[system] = {name: folder / file.text() for name, file in files.mapping(sorted(sequences)).items()}
    return others


def options_of(*levels):
    """Options of several levels in one; of options that are there twice the last one counts."""
    groups = {}
    for word in (word for level in levels for word in level):
        if word.startswith("--"):
            name, equals, value = word.partition("=")
            groups[name] = [value] if equals else []
        elif groups:
            groups[name].append(word)
    return [word for name, values in groups.items() for word in [name, *values]]


def merged(below, above):
    """Both configurations in one; `above` counts where both say something."""
    result = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = merged(result[key], value) if both else value
    return result

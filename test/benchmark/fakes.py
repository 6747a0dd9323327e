"""Programs that stand in for mba_vo_offline, mba_vo_evaluate and mba_vo_export: they do what the path of the sequence says. And a folder
of its own for each test."""
import os
import pathlib
import stat
import tempfile
import textwrap
import unittest

OFFLINE = """#!/bin/sh
# SEQUENCE --output FOLDER OPTION...
echo "$$ $*" >>"{calls}"
case "$1" in
  *broken*) echo "$1: spoilt on purpose"; exit 1 ;;
  *once*) if [ ! -e "$1/tried" ]; then touch "$1/tried"; echo "busy"; exit 1; fi ;;
  *killed*) kill -9 $$ ;;
  *hangs*) echo "$$" >>"{children}"; exec sleep 1000 ;;
esac
printf '%s\\n' "$@" >"$3/options.txt"
echo 'times: {{tracking: {{per_frame_ms: 7.5}}}}' >"$3/summary.yaml"
printf 'sequence,online_status,reason,blur_px,error_px\\n0,INITIALIZING,,,\\n1,TRACKING,,3.5,0.1\\n2,TRACKING,,4.5,0.25\\n3,TRACKING,,,0.2\\n' >"$3/frames.csv"
"""

EVALUATE = """#!/bin/sh
# --groundtruth TRUTH --run|--estimate WHAT --yaml FILE [--plot FILE]: the ATE [m] is the first word of the truth's file ate
ate=$(cat "$2/ate" 2>/dev/null || echo 0.01)
if [ "$3" = --estimate ]; then
  [ -e "$4" ] || {{ echo "$4: cannot be read"; exit 1; }}
  printf 'ate: {{rmse: 0.02}}\\ndropped_percent: 0\\n' >"$6"
else
  skip=$(grep -A 1 -e --skip "$4/options.txt" | tail -n 1)
  echo "causal: {{map: {{ate: {{rmse: $ate$skip}}}}, restarts: 0, availability: {{pose_in_time: {{percent: 90}}}}}}" >"$6"
  echo "smoothed: {{ate: {{rmse: .nan}}}}" >>"$6"
fi
if [ "${{7:-}}" = --plot ]; then echo picture >"$8"; fi
"""

EXPORT = """#!/bin/sh
# SEQUENCE --output FOLDER OPTION...
case "$1" in *cannot_be_exported*) echo "no picture"; exit 1 ;; esac
mkdir -p "$3/dso/images"
echo "$*" >"$3/dso/options.txt"
echo worst >"$3/dso/images/000000.png"
"""


class Fakes:
    """A folder with the programs and a folder of sequences."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.bin, self.data = self.folder / "bin", self.folder / "data"
        self.calls, self.children = self.folder / "calls.txt", self.folder / "children.txt"
        self.bin.mkdir()
        for name, text in (("mba_vo_offline", OFFLINE), ("mba_vo_evaluate", EVALUATE), ("mba_vo_export", EXPORT)):
            file = self.bin / name
            file.write_text(text.format(calls=self.calls, children=self.children))
            file.chmod(file.stat().st_mode | stat.S_IXUSR)

    def add_sequence(self, name, ate="0.01"):
        sequence = self.data / name
        sequence.mkdir(parents=True)
        (sequence / "ate").write_text(ate)
        return sequence

    def made(self):
        """Calls of mba_vo_offline until now."""
        return self.calls.read_text().splitlines() if self.calls.exists() else []

    def processes(self):
        """All that mba_vo_offline was, and started."""
        children = self.children.read_text().split() if self.children.exists() else []
        return [int(line.split()[0]) for line in self.made()] + [int(child) for child in children]


def alive(process):
    """A process that is neither gone nor a zombie."""
    try:
        with open("/proc/%d/stat" % process, encoding="ascii", errors="replace") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def files_below(folder):
    return sorted(os.path.relpath(os.path.join(root, name), folder) for root, _, names in os.walk(folder) for name in names)


class InFolder(unittest.TestCase):
    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self._temporary.cleanup)
        self.folder = pathlib.Path(self._temporary.name)

    def write(self, text, name="experiment.yaml"):
        file = self.folder / name
        file.write_text(textwrap.dedent(text))
        return file

"""What is going on, line by line; on a terminal with a bar and the time that is left."""
import sys
import time

BAR = 30  # characters


class Progress:
    def __init__(self, describe, stream=sys.stderr):
        """`describe(task)`: what a task that ended has found, in a few words."""
        self._describe, self._stream, self._terminal = describe, stream, stream.isatty()
        self.period = 1.0  # [s] between two looks at the clock
        self._total = self._todo = self._done = 0
        self._jobs, self._began = 1, time.monotonic()

    def begin(self, total, todo, jobs):
        self._total, self._todo, self._jobs, self._began = total, todo, jobs, time.monotonic()
        if todo < total:
            self._line("%d of %d runs are there already" % (total - todo, total))

    def repeat(self, count):
        if count:
            self._todo += count
            self._total += count
            self._line("%d failed: once more, one at a time" % count)

    def ended(self, task):
        self._done += 1
        self._line("[%d/%d] %s: %s" % (self._total - self._todo + self._done, self._total, task.name, self._describe(task)))

    def show(self, running):
        if self._terminal:
            filled = BAR * (self._total - self._todo + self._done) // max(1, self._total)
            self._stream.write("\r\033[K[%s] %d running%s" % ("#" * filled + "-" * (BAR - filled), running, self._left()))
            self._stream.flush()

    def end(self):
        if self._terminal:
            self._stream.write("\r\033[K")

    def _left(self):
        if self._done == 0:
            return ""
        seconds = (time.monotonic() - self._began) / self._done * (self._todo - self._done)
        return ", %s left" % ("%.0f s" % seconds if seconds < 100 else "%.0f min" % (seconds / 60))

    def _line(self, text):
        self._stream.write(("\r\033[K" if self._terminal else "") + text + "\n")
        self._stream.flush()

"""Runs tasks side by side, each on cores of its own; what failed is repeated alone."""
import json
import os
import pathlib
import shutil
import time

from .processes import Running, Waiter

RECORD = "run.json"  # in the folder of a task that has ended
PART = ".part"  # of the folder of one that has not


class Task:
    """Programs to be run one after the other, and the folder where their results go.

    `steps(folder)` gives pairs of command and whether it may fail, each asked for when the one before has ended; `prepare(folder)`
    writes what they need.
    """

    def __init__(self, name, folder, key, steps, prepare=lambda folder: None):
        self.name, self.folder, self.key, self.steps, self.prepare = name, pathlib.Path(folder), key, steps, prepare
        self.record = self._found()

    def _found(self):
        try:
            record = json.loads((self.folder / RECORD).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return record if record.get("key") == self.key and record.get("reason") is None else None


class _Attempt:
    """A task at work."""

    def __init__(self, task, cores, number):
        self.task, self.cores, self.number = task, cores, number
        self.began = time.monotonic()
        self.part = task.folder.with_name(task.folder.name + PART)
        shutil.rmtree(self.part, ignore_errors=True)
        self.part.mkdir(parents=True)
        task.prepare(self.part)
        self._steps = iter(task.steps(self.part))
        self._optional = False
        self.running = None

    def next_step(self):
        """Starts the next program; None if all are done."""
        step = next(self._steps, None)
        if step is None:
            return None
        command, self._optional = step
        self.running = Running(command, self.part / "log.txt", self.cores)
        return self.running

    def reason(self):
        """Why the program that ended failed; None if it did not."""
        status = self.running.result()
        if status == 0 or self._optional:
            return None
        lines = (self.part / "log.txt").read_text(encoding="utf-8", errors="replace").split("\n")
        said = [line.strip() for line in lines if line.strip()]
        if status < 0:
            return "ended by signal %d%s" % (-status, "; last: " + said[-1] if said else "")
        return said[-1] if said else "exit status %d without a message" % status

    def finish(self, reason):
        record = {"key": self.task.key, "reason": reason, "attempts": self.number, "seconds": round(time.monotonic() - self.began, 3)}
        (self.part / RECORD).write_text(json.dumps(record) + "\n", encoding="utf-8")
        shutil.rmtree(self.task.folder, ignore_errors=True)
        os.replace(self.part, self.task.folder)
        self.task.record = record


class Scheduler:
    """`stopped()` is asked between steps: an exception in the midst of them could leave a process behind."""

    def __init__(self, cores, jobs, time_limit, progress, stopped):
        self._stopped = stopped
        self._cores, self._jobs, self._time_limit, self._progress = cores, jobs, time_limit, progress

    def run(self, tasks):
        """All that have no result yet; afterwards each has a record."""
        todo = [task for task in tasks if task.record is None]
        self._progress.begin(len(tasks), len(todo), self._jobs)
        self._run_side_by_side(todo, self._jobs, 1)
        failed = [task for task in todo if task.record["reason"] is not None]
        self._progress.repeat(len(failed))
        self._run_side_by_side(failed, 1, 2)
        self._progress.end()

    def _cores_of(self, slot, slots):
        return self._cores[slot::slots] or [self._cores[slot % len(self._cores)]]

    def _run_side_by_side(self, todo, slots, number):
        todo, free, attempts, waiter = list(todo), list(range(slots)), {}, Waiter()
        try:
            while todo or attempts:
                if self._stopped():
                    raise KeyboardInterrupt
                while todo and free:
                    slot = free.pop(0)
                    attempt = _Attempt(todo.pop(0), self._cores_of(slot, slots), number)
                    waiter.add(attempt.next_step())
                    attempts[slot] = attempt
                ended = waiter.ended(self._progress.period)
                for slot, attempt in list(attempts.items()):
                    if attempt.running in ended and self._went_on(attempt, waiter) or self._took_too_long(attempt, waiter):
                        del attempts[slot]
                        free.append(slot)
                self._progress.show(len(attempts))
        finally:
            for attempt in attempts.values():
                attempt.running.kill()
                shutil.rmtree(attempt.part, ignore_errors=True)

    def _went_on(self, attempt, waiter):
        """Whether the task ended with its program."""
        reason = attempt.reason()
        following = attempt.next_step() if reason is None else None
        if following is not None:
            waiter.add(following)
            return False
        attempt.finish(reason)
        self._progress.ended(attempt.task)
        return True

    def _took_too_long(self, attempt, waiter):
        if time.monotonic() - attempt.began < self._time_limit:
            return False
        waiter.remove(attempt.running)
        attempt.running.kill()
        attempt.finish("stopped after %g s, the time limit" % self._time_limit)
        self._progress.ended(attempt.task)
        return True


def remove_leftovers(folder):
    """Of a benchmark that was killed."""
    for part in pathlib.Path(folder).glob("*" + PART):
        shutil.rmtree(part, ignore_errors=True)

"""One program at a time for each of several tasks; none outlives this program, however it ends."""
import os
import selectors
import signal
import subprocess
import time


class Running:
    """A program that writes into a log. It is killed with its children, also when this program is killed."""

    def __init__(self, command, log, cores):
        self.began = time.monotonic()
        wrapped = ["setpriv", "--pdeathsig", "KILL", "taskset", "--cpu-list", ",".join(str(core) for core in cores)]
        with open(log, "ab") as output:
            self._process = subprocess.Popen(wrapped + [str(word) for word in command], stdin=subprocess.DEVNULL, stdout=output,
                                             stderr=subprocess.STDOUT, start_new_session=True)
        self.descriptor = os.pidfd_open(self._process.pid)

    def result(self):
        """Exit status, once it has ended."""
        os.close(self.descriptor)
        return self._process.wait()

    def kill(self):
        try:
            os.killpg(self._process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass  # it has just ended
        self.result()


class Waiter:
    """Tells which of the programs have ended."""

    def __init__(self):
        self._selector = selectors.DefaultSelector()

    def add(self, running):
        self._selector.register(running.descriptor, selectors.EVENT_READ, running)

    def remove(self, running):
        self._selector.unregister(running.descriptor)

    def ended(self, timeout):
        """Those that ended, as soon as there is one; none after the timeout [s]."""
        found = [key.data for key, _ in self._selector.select(timeout)]
        for running in found:
            self.remove(running)
        return found


def usable_cores():
    """Cores that this program may use, by its affinity and by the quota of its container."""
    cores = sorted(os.sched_getaffinity(0))
    try:
        with open("/sys/fs/cgroup/cpu.max", encoding="ascii") as file:
            quota, period = file.read().split()
        return cores if quota == "max" else cores[:max(1, int(quota) // int(period))]
    except (OSError, ValueError):
        return cores

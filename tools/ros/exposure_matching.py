"""Which exposure belongs to which image. Times `now` [s] are of arrival, on any one clock."""
import collections
import math

UNKNOWN = float("nan")
MOST = 1000  # values, or images, that are remembered while they wait for each other


class _Image:
    def __init__(self, stamp, number, arrival):
        self.stamp = stamp
        self.number = number
        self.arrival = arrival
        self.exposure = None  # not known yet


class _Value:
    def __init__(self, exposure, number, arrival):
        self.exposure = exposure
        self.number = number
        self.arrival = arrival


class Matching:
    """Images wait for their exposures, at most `timeout` [s], and leave in their order; then it is unknown."""
    needs_images = True

    def __init__(self, timeout):
        self.timeout = timeout
        self.images = collections.deque(maxlen=MOST)
        self.values = collections.deque(maxlen=MOST)

    def add_image(self, now, stamp, number):
        self.images.append(_Image(stamp, number, now))

    def add_value(self, now, exposure, stamp, number):
        self.values.append(_Value(exposure, number, now))

    def take(self, now):
        """Pairs of stamp and exposure that are settled."""
        self._match(now)
        settled = []
        while self.images:
            image = self.images[0]
            late = now - image.arrival > self.timeout
            if image.exposure is None and not late:
                break
            self.images.popleft()
            settled.append((image.stamp, UNKNOWN if image.exposure is None else image.exposure))
        return settled

    def _match(self, now):
        raise NotImplementedError

    def _forget_values_before(self, time):
        while self.values and self.values[0].arrival < time:
            self.values.popleft()


class StampMatching(Matching):
    """The message has the stamp of its image."""
    needs_images = False

    def __init__(self, timeout):
        Matching.__init__(self, timeout)
        self._settled = []

    def add_value(self, now, exposure, stamp, number):
        self._settled.append((stamp, exposure))

    def take(self, now):
        settled, self._settled = self._settled, []
        return settled


class SequenceMatching(Matching):
    """The number of the message plus an offset is the sequence number in the header of the image."""

    def __init__(self, timeout, offset=0):
        Matching.__init__(self, timeout)
        self._offset = offset

    def _match(self, now):
        by_number = {value.number + self._offset: value for value in self.values}
        for image in self.images:
            if image.exposure is None and image.number in by_number:
                image.exposure = by_number[image.number].exposure
                self.values.remove(by_number[image.number])
        self._forget_values_before(now - 2.0 * self.timeout)


class LatestMatching(Matching):
    """The newest message before an image, however old: settings, not measurements."""

    def _match(self, now):
        for image in self.images:
            while len(self.values) > 1 and self.values[1].arrival <= image.arrival:
                self.values.popleft()
            if image.exposure is None and self.values and self.values[0].arrival <= image.arrival:
                image.exposure = self.values[0].exposure


class ArrivalMatching(Matching):
    """Image and message that arrive closest together, each other's nearest, once nothing nearer can come any more."""

    def _match(self, now):
        pairs = sorted(((abs(image.arrival - value.arrival), index, image, value)
                        for index, image in enumerate(self.images) if image.exposure is None
                        for value in self.values), key=lambda pair: pair[:2])
        done = set()
        for distance, _, image, value in pairs:
            if distance > self.timeout or id(image) in done or id(value) in done:
                continue
            done.update((id(image), id(value)))
            if now - max(image.arrival, value.arrival) >= distance:
                image.exposure = value.exposure
                self.values.remove(value)
        self._forget_values_before(now - 2.0 * self.timeout)


MATCHINGS = {"stamp": StampMatching, "sequence": SequenceMatching, "latest": LatestMatching, "arrival": ArrivalMatching}


def suspicion(exposure):
    """Why an exposure [s] looks as if its unit were wrong; None if it does not."""
    if math.isnan(exposure) or 50e-6 <= exposure <= 1.0:
        return None
    return "an exposure of %g s is unusually %s: is the unit right?" % (exposure, "long" if exposure > 1.0 else "short")

"""YAML whose errors name file, key, value and what is allowed."""
import math
import shlex

import yaml

from .errors import BenchmarkError


class UniqueKeyLoader(yaml.SafeLoader):
    """PyYAML takes the last of two equal keys; here they are an error."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        twice = [key for key in keys if keys.count(key) > 1]
        if twice:
            raise yaml.constructor.ConstructorError(None, None, "key '%s' is there twice" % twice[0], node.start_mark)
        return super().construct_mapping(node, deep)


class Node:
    """A value with the file and the key where it stands."""

    def __init__(self, file, key, value):
        self.file, self.key, self.value = file, key, value

    def error(self, allowed):
        return BenchmarkError("%s: %s: '%s': must be %s" % (self.file, self.key or "the file", self.value, allowed))

    def mapping(self, allowed_keys=None):
        """Nodes by key, empty for nothing. Only keys that are allowed; None allows all."""
        if self.value is None:
            return {}
        if not isinstance(self.value, dict):
            raise self.error("keys with values" + (": " + ", ".join(allowed_keys) if allowed_keys else ""))
        for key in self.value:
            if allowed_keys is not None and key not in allowed_keys:
                place = "%s.%s" % (self.key, key) if self.key else key
                raise BenchmarkError("%s: %s: no such key; allowed: %s" % (self.file, place, ", ".join(allowed_keys)))
        return {str(key): Node(self.file, "%s.%s" % (self.key, key) if self.key else str(key), value)
                for key, value in self.value.items()}

    def text(self):
        if not isinstance(self.value, str) or not self.value:
            raise self.error("text")
        return self.value

    def number(self, low, allowed):
        good = isinstance(self.value, (int, float)) and not isinstance(self.value, bool)
        if not good or not low <= self.value < math.inf:
            raise self.error(allowed)
        return self.value

    def words(self):
        """Options as on a command line: one text, or a list."""
        if isinstance(self.value, str):
            try:
                return shlex.split(self.value)
            except ValueError as error:
                raise self.error("options as on a command line (%s)" % str(error).lower()) from None
        good = isinstance(self.value, list) and all(
            isinstance(word, (str, int, float)) and not isinstance(word, bool) for word in self.value)
        if not good:
            raise self.error("options as on a command line, one text or a list")
        return [str(word) for word in self.value]

    def items(self, allowed):
        if not isinstance(self.value, list) or not self.value:
            raise self.error(allowed)
        return [Node(self.file, "%s[%d]" % (self.key, index), value) for index, value in enumerate(self.value)]


def load(file):
    """The root node of a file."""
    try:
        with open(file, encoding="utf-8") as stream:
            return Node(str(file), "", yaml.load(stream, UniqueKeyLoader))
    except OSError as error:
        raise BenchmarkError("%s: cannot be read: %s" % (file, error.strerror)) from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BenchmarkError("%s: no YAML: %s" % (file, " ".join(str(error).split()))) from None

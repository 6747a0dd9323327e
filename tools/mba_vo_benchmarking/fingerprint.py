"""What a run depends on, as one short text: programs, command, configuration and sequence."""
import functools
import hashlib
import json
import os


@functools.lru_cache(maxsize=None)
def of_program(file):
    with open(file, "rb") as stream:
        return hashlib.sha256(stream.read()).hexdigest()


@functools.lru_cache(maxsize=None)
def of_sequence(path):
    """Names, sizes and times of all files: contents would take minutes for a data set."""
    if not os.path.isdir(path):
        return _of_files([path], os.path.dirname(path))
    files = [os.path.join(folder, name) for folder, _, names in os.walk(path) for name in names]
    return _of_files(sorted(files), path)


def _of_files(files, root):
    digest = hashlib.sha256()
    for file in files:
        status = os.stat(file)
        digest.update(("%s %d %d\n" % (os.path.relpath(file, root), status.st_size, status.st_mtime_ns)).encode())
    return digest.hexdigest()


def combined(parts):
    """Of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:20]

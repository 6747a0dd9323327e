"""What a user can put right."""


class BenchmarkError(Exception):
    """Says what is wrong, with the value and what is allowed."""

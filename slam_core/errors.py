"""The root of every error that a person is meant to read."""


class SlamError(Exception):
    """A mistake with a remedy: the message gives the fact, the value and what to do."""

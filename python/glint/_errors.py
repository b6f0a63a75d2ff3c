"""What Glint raises on purpose. Anything else is a bug in Glint."""


class Error(Exception):
    """Base of all of Glint's own exceptions."""


class InputError(Error, ValueError):
    """A bad file, array, argument or configuration; the message says what was expected and what was found.

    Attributes:
        path: the file or folder, or "" where it is not about one.
        record: the place in the file, or the name of the argument; may be "".
    """

    def __init__(self, message: str, path: str = "", record: str = ""):
        super().__init__(message)
        self.path = path
        self.record = record

    def __reduce__(self):
        return type(self), (str(self), self.path, self.record)


class NoResultError(Error):
    """The input was sound, but no honest result follows from it: for example, no highlights were found."""


class CancelledError(Error):
    """The work was asked to stop."""

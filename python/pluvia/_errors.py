"""Errors and warnings. Their messages are those of the program `pluvia`."""


class Error(Exception):
    """Any error of Pluvia."""


class ScenarioError(Error, ValueError):
    """The scenario or the arguments have faults. The message lists all, each with its place and what is allowed."""


class SimulationError(Error, RuntimeError):
    """The simulation failed. Its last good state is kept; the message says where."""


class FileError(Error, OSError):
    """A file could not be read or written."""


class ScenarioWarning(UserWarning):
    """The program warns of something in a scenario, before or while it runs."""


class NotValidWarning(UserWarning):
    """A run that is not valid, so that its numbers must not be quoted, or that is left out of means; the message says
    why."""


def raised(code: int, what: str) -> BaseException:
    """The exception of an exit code of the program."""
    kinds: dict[int, type[Error]] = {2: ScenarioError, 3: SimulationError, 4: FileError}
    return KeyboardInterrupt(what) if code == 130 else kinds.get(code, Error)(what)

"""What may go wrong. The words are those of the program `pluvia`, all of them."""


class Error(Exception):
    """Any error of Pluvia."""


class ScenarioError(Error, ValueError):
    """The scenario, or what was asked for, has faults: all of them, each with its place and what is allowed."""


class SimulationError(Error, RuntimeError):
    """The simulation failed. Its last good state is kept; the message says where."""


class FileError(Error, OSError):
    """A file could not be read or written."""


class ScenarioWarning(UserWarning):
    """What the program says of a scenario before or while it runs."""


class NotValidWarning(UserWarning):
    """A run whose numbers are none to quote, or are left out of means; the message says why."""


def raised(code: int, what: str) -> BaseException:
    """The exception of an exit code of the program."""
    kinds: dict[int, type[Error]] = {2: ScenarioError, 3: SimulationError, 4: FileError}
    return KeyboardInterrupt(what) if code == 130 else kinds.get(code, Error)(what)

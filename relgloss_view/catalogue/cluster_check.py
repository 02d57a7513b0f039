"""Whether a running cluster has this program, asked before any task is sent.

Dask loads what it is sent: a worker without relgloss would end itself over the first task, and a
scheduler without it would refuse each. So both are first asked by functions that every Python has.
"""

from __future__ import annotations

import pkgutil
import threading
from collections.abc import Collection
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.cluster_worker import Program, this_program

VERSION = "relgloss_view.base.version:__version__"
REMEDY = "install the same relgloss there"


def check_scheduler(client: Any, address: str) -> None:
    """Raise InputError where the scheduler can't load this program's tasks."""
    try:
        client.run_on_scheduler(pkgutil.resolve_name, VERSION)
    except (ImportError, AttributeError) as error:
        raise InputError(f"scheduler {address}: it has no relgloss ({error}); {REMEDY}") from None
    except Exception:  # it does not let anyone ask: the first task will show
        return


class Inspection:
    """Which workers may get tasks: those that have answered, and with this program.

    Each is asked in a thread of its own, because one that hangs never answers.
    """

    def __init__(self, client: Any, expected: Program) -> None:
        self._client, self._expected = client, expected
        self._asked: dict[str, list[InputError | bool]] = {}  #: what has come of it, by address

    def passed(self, present: Collection[str]) -> set[str]:
        """Those of the workers that have passed; raises InputError where one has another program.

        New ones are asked, and may pass the next time.
        """
        for address in self._asked.keys() - set(present):
            del self._asked[address]
        passed = set()
        for address in present:
            come = self._asked.get(address)
            if come is None or False in come:
                come = self._asked[address] = []
                words = (self._client, address, self._expected, come)
                threading.Thread(target=_inspect, args=words, daemon=True).start()
            for outcome in come:
                if isinstance(outcome, InputError):
                    raise outcome
                passed.add(address)
        return passed


def _inspect(
    client: Any, address: str, expected: Program, outcome: list[InputError | bool]
) -> None:
    """Ask a worker. The outcome is True, False where it can't be asked, or what is wrong."""
    try:
        outcome.append(_check_worker(client, address, expected))
    except InputError as error:
        outcome.append(error)
    except Exception:  # the client is closed, or the worker has gone meanwhile
        outcome.append(False)


def _check_worker(client: Any, address: str, expected: Program) -> bool:
    version = _answer(client, address, pkgutil.resolve_name, VERSION)
    if isinstance(version, (ImportError, AttributeError)):
        raise InputError(f"worker {address}: it has no relgloss ({version}); {REMEDY}")
    if isinstance(version, Exception):
        return False
    if version != expected.version:
        raise InputError(
            f"worker {address}: relgloss {version} in place of {expected.version}; {REMEDY}"
        )
    program = _answer(client, address, this_program)
    if isinstance(program, OSError):
        return False
    if isinstance(program, Exception):
        raise InputError(f"worker {address}: another relgloss ({program}); {REMEDY}")
    difference = expected.difference(program)
    if difference:
        raise InputError(f"worker {address}: another program: {difference}; {REMEDY}")
    return True


def _answer(client: Any, address: str, *words: Any) -> Any:
    """What a worker answers: a result, or an exception."""
    return client.run(*words, workers=[address], on_error="return")[address]

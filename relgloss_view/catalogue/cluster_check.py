"""Whether a running cluster has this program, asked before any task is sent.

Dask loads what it is sent: a worker without relgloss would end itself over the first task, and a
scheduler without it would refuse each. So both are first asked by functions that every Python has.
"""

from __future__ import annotations

import pkgutil
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


def checked(client: Any, addresses: Collection[str], expected: Program) -> set[str]:
    """Those of the workers that have answered; raises InputError where one has another program."""
    answers = _answers(client, addresses, pkgutil.resolve_name, VERSION)
    for address, version in answers.items():
        if isinstance(version, (ImportError, AttributeError)):
            raise InputError(f"worker {address}: it has no relgloss ({version}); {REMEDY}")
        if version != expected.version:
            raise InputError(
                f"worker {address}: relgloss {version} in place of {expected.version}; {REMEDY}"
            )
    programs = _answers(client, answers, this_program)
    for address, program in programs.items():
        if isinstance(program, Exception):
            raise InputError(f"worker {address}: another relgloss ({program}); {REMEDY}")
        difference = expected.difference(program)
        if difference:
            raise InputError(f"worker {address}: another program: {difference}; {REMEDY}")
    return set(programs)


def _answers(client: Any, addresses: Collection[str], *words: Any) -> dict[str, Any]:
    """What workers answer, by address; those that have gone in the meantime are left out."""
    if not addresses:
        return {}
    try:
        given = client.run(*words, workers=list(addresses), on_error="return")
    except (OSError, TimeoutError, ValueError):
        return {}
    return {key: value for key, value in given.items() if not isinstance(value, OSError)}

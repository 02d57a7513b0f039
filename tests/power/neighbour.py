"""Any other program of the machine: it writes to the same disk and has its own file kept.

Run: python neighbour.py FILE PERIOD_S, until it is killed. The kernel then keeps the names that
others have changed so far, whether or not their content is on the disk.
"""

from __future__ import annotations

import os
import sys
import time


class Neighbour:
    """One file, written and kept again and again."""

    def __init__(self, path: str) -> None:
        self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        self._fsync = os.fsync  # before anybody replaces it
        self._count = 0

    def keep(self) -> None:
        self._count += 1
        os.pwrite(self._file, b"%d" % self._count, 0)
        self._fsync(self._file)


def main(path: str, period_s: float) -> None:
    neighbour = Neighbour(path)
    while True:
        neighbour.keep()
        time.sleep(period_s)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))

"""The profile of the monitor that a window lies on, as the system has it: bytes, not yet read."""

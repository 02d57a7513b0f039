"""The window in which people judge pictures: one observer's session, phase by phase."""

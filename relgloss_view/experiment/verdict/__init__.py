"""Which settings are best, how surely, and how far observers agree."""

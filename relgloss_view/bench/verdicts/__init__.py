"""Is a fit's "good" good? Tables with a known truth and a named fault each (docs/verdicts.md)."""

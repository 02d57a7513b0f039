"""The commands of `relgloss`, one module each: `add` declares the options, `run` does the work."""

"""What a gloss meter would read."""

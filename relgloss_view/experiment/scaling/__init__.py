"""From counts of answers to scale values, category bounds and a smooth closeness."""

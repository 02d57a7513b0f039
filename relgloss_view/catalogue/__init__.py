"""A catalogue: every table, material and proof of a tree, fitted, metered, matched and drawn."""

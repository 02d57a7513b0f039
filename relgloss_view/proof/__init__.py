"""The proof: one file that a designer sends and a maker opens."""

"""Other programs that draw the same picture."""

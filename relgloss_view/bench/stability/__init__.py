"""Maps of where methods fail."""

"""Materials and packs in the words of other programs, and back, with what is lost on the way."""

"""Searches of a catalogue: the language, what a query holds, how hits are ranked."""

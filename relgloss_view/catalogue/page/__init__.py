"""The page of a catalogue or of what a search has found: one file for any browser."""

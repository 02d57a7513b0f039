"""The subjective evaluation: which settings keep the ratio of gloss, by asking people."""

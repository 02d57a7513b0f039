"""Gloss of samples and pictures: meters, what a display shows, matching, comparison."""

"""Simulated observers with a known truth."""

"""Puts this folder on the path of its rooms' tests, which share cases.py and report_cases.py."""

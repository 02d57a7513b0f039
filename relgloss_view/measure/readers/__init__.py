"""One reader a format, chosen by content."""

"""Artwork: pictures and PDF files as colours under D50 and as plates."""

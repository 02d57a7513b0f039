"""What is made of an analysis: sentences, numbers, tables, plots, scene files and a page."""

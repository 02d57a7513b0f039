"""Files in and out of the window, in the background."""

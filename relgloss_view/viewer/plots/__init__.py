"""What the plots and the pixel inspector show, as arrays: pure numpy, no window."""

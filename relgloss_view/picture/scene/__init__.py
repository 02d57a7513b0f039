"""Values that describe a picture: sample, setup, look, and the files that hold them."""

"""What a picture shows: sample, setup, look, and the files that hold them. Values only."""

"""The reflection of a sample: models, materials and their files, spectra."""

"""What the sample is: reflection models, materials, fit, spectra."""

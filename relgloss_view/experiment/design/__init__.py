"""What is judged, fixed before the first observer sits down: grid, study, order, stimuli."""

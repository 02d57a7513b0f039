"""A material from a few gloss readings and a colour, as a distribution (docs/estimate.md).

In order: `given` (the readings and their errors), `colour` (what the lobe leaves of the colour),
`prior` (what is believed before any reading), `model` (what the instruments would read), `sampler`
(draws that fit the readings), `contradiction`, `estimate` (all of it), `describe` and `report` (how
people read it).
"""

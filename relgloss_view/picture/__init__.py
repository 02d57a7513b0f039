"""How a sample is drawn: scene, noise, tone, shaders, renderer, reference."""

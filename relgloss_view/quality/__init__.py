"""How little of the model is enough for a scene."""

"""Speed against accuracy: what each simplification of the model costs and saves."""

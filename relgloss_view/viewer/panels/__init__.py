"""Panels: each draws one window's contents from the model and changes it. None touches OpenGL."""

"""The window: state and history without a screen, panels without OpenGL, one loop over both."""

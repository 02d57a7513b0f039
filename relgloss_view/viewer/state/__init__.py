"""What the window shows, as values: no OpenGL, no window library."""

"""A scene and a look become a Frame on the GPU, for window, files and tests alike.

With bench/ the only room that imports moderngl.
"""

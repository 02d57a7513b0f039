"""The numpy twins of the shader libraries, in float64."""

"""What a monitor shows: sRGB, gain-offset-gamma, ICC profiles, readings; XYZ to digital values."""

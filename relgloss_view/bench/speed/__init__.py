"""Time against error for each way of drawing."""

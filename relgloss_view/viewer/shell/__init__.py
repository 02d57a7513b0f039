"""The window itself: platform, keyboard, layout, actions, the loop."""

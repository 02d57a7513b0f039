"""From the state to pictures in the pane."""

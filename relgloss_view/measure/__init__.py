"""What an instrument measured: its geometry, its tables and their readers."""

"""What an instrument saw: geometry, tables and their readers."""

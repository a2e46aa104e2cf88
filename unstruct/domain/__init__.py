"""What is to be meshed, checked exactly."""

"""What is drawn: states and histories of algorithms, as pure functions to frames."""

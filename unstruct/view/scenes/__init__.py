"""The states and histories of algorithms as frames, computed by pure functions."""

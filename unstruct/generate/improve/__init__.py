"""Smoothing: vertices that move to better places."""

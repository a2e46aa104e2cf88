"""Widgets with sliders and buttons that show the scenes, and the player that steps through frames."""

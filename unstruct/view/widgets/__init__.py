"""Shells with sliders and buttons around the scenes, and the player that steps through frames."""

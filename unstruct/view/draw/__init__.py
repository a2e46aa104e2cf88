"""Drawing with matplotlib, and the view in space: colors, frames, strips, plots."""

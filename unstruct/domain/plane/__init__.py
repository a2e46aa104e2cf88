"""Planar domains: sampling, corners, faults, repairs, shapes, files."""

"""What every room stands on: errors, checked arguments and arrays, compiled kernels, progress, reports."""

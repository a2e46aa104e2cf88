"""What every other package uses: errors, checked arguments and arrays, kernels, progress bars, reports."""

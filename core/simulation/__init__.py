"""The time loop: steps, error control, events, dense output, samples."""

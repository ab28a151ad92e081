"""The time loop, compiled: steps, error control, sampling, `drive`."""

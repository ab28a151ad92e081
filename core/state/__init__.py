"""What a run remembers and works on: layouts of the records, modes of contacts."""

"""What can be done with a result: text, tables, files, plots, a model to go on from. `Result` has a method for each."""

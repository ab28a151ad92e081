"""From a model to flat arrays: numbering, sparsity, workspace, evaluation, partition, consistent start."""

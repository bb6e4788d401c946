"""The values that pass between stages: fields and `check`, nothing else."""

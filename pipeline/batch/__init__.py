"""Many jobs: what is to be run, who runs it, what became of it."""

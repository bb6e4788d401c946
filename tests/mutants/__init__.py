"""Would the tests notice?  Faults of one place each, planted in a copy of the program, and the tests run."""

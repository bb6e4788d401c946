"""The measures W1 to W16 of a cut file, taken over all samples: `python -m tests.bench.cutfiles [W1 W2 ...]`.

One table: what is measured, its goal, what was reached, how, and whether all of it was looked at or samples.  What
tests measure already is asked of them; nothing is measured twice in two ways that might drift apart.
"""

"""Mutants that no test can tell from the program, by seed and number, each with the reason: they are counted apart."""

EQUIVALENT: dict[int, dict[int, str]] = {
    1: {
        16: "the edges at an apex have no length: any place along one is the apex",
        49: "the error is caught where the cut is tried, a few lines above, and its two numbers are never read",
        57: "asking for the exact box of more paths than may swell costs time alone: that of all is the same",
    },
}

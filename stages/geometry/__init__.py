"""Mathematics on plain arrays.  Knows no part, no job and no stage."""

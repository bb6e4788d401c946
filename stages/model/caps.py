"""How many things a job file may hold, each cap with its reason; what is over one is refused before any work.

A cap is far above what shops cut and far below what would fill the memory: it is there for slips of the keyboard, for
programs that write job files and count wrong, and for whoever would stop a machine that runs the jobs of others.
"""

MOST_PARTS = 10_000
"""Of a job: a ship has as many plates; more belong into several jobs, which a batch runs in parallel."""
MOST_COPIES = 100_000
"""Of all parts of a job together: so many take minutes to place even where each place is obvious."""
MOST_STOCK = 1000
"""Entries of stock in a job; each may stand for any number of equal sheets."""
MOST_PLACES = 300
"""Defects, or zones, of one piece of stock: a scanned hide has some ten."""
MOST_FEATURES = 10_000
"""Holes, marks, notches or seams of one part: a perforated plate of 1 m2 with a pitch of 10 mm."""
MOST_POINTS = 20_000
"""Of one curve: an outline of 2 m scanned every 0.1 mm."""
MOST_PIECES = 1000
"""Curves of a chain, surfaces of a strip, patches: more than a hundred are a mesh that lost its faces."""
MOST_ANGLES = 3600
"""Angles that a part may be turned by: every tenth of a degree."""
LARGEST_MM = 10**6
"""Of any length or coordinate of a surface: a kilometre.  Coordinates of a survey are to be shifted near 0."""
MOST_CHORDS = 2e7
"""A part is at most so many times as large as its contours are exact: a kilometre at the 0.05 mm that are usual.  A
circle of that size takes 10 000 chords, and beyond it each stage takes the time of thousands of usual parts."""
MOST_ROWS = 1000
"""Rows of a table of values, or names in a list."""

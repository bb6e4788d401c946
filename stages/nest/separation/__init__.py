"""A search for dense layouts: items that overlap are moved until they do not; then there is less room."""

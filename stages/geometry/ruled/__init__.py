"""Ruled patches and strips of them in space: what they are, where they bend, meet and cross."""

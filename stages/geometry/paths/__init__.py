"""Paths of lines and arcs: what is cut, made from exact edges, measured and kept apart in closed form."""

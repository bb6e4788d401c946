"""Curves in space and in the plane, and what is laid along them."""

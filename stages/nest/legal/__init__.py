"""The certifier: one module a rule."""

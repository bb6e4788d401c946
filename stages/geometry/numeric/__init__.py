"""Polynomials, series, quadrature, roots, fits and linear equations: numbers before any shape."""

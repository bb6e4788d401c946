"""Faces of CAD files."""

"""Orchestration: files, clocks, processes, people.  No geometry."""

__version__ = "0.1.0"

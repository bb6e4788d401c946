"""Developable strips between two rails."""

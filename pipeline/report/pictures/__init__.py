"""Pictures of parts and sheets as PNG."""

"""CAD files: read in a child process."""

"""What the page needs to draw parts and sheets."""

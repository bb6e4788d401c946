"""What a finished job says of itself: JSON and pictures."""

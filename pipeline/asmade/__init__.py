"""What was measured of made parts beside what the job asked for."""

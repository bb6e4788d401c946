"""What independent readers of DXF make of our cut files: the first opinion that is not our own."""

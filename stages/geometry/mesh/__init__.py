"""Triangle meshes: what they stand for, and how they are laid into the plane."""

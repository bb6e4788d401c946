"""Maps of ruled strips onto the plane, and curves carried through them."""

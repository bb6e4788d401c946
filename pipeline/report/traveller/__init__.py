"""The sheet of paper that goes with a part through the shop, as PDF."""

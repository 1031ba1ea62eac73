"""The robot's clock, which a check drives, and what a node's answers prove about it."""

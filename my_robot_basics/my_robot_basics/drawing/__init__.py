"""Pictures of the two-link arm as PNG, and a picture together with its alternative text."""

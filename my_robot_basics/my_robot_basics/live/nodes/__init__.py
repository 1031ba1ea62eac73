"""Nodes of a notebook: started, replaced and stopped, the answer's among them."""

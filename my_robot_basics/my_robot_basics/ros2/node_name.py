"""The name of a node on the graph."""

from typing import NamedTuple


class NodeName(NamedTuple):
    """A node's name on the graph."""

    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """The name with its namespace, such as `/arm/driver`."""
        return f'{self.namespace.rstrip("/")}/{self.name}'

"""The block contract: ports, blocks and the graph that steps them."""

from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph

__all__ = ["Block", "Graph", "Port"]

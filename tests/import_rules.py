"""A kind of import contract: the files of a folder stand apart, but for the helpers that they share."""

from itertools import permutations

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output


class SiblingsContract(Contract):
    """No module of a folder reaches another one, not even by way of a helper (a name with _ in front)."""

    type_name = "siblings"
    folders = fields.ListField(subfield=fields.StringField())

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        """Look for an import chain between each pair of siblings; packages count as their whole content."""
        chains = []
        for folder in self.folders:
            names = [m for m in sorted(graph.find_children(folder)) if not m.rpartition(".")[2].startswith("_")]
            for importer, imported in permutations(names, 2):
                if chain := graph.find_shortest_chain(importer, imported, as_packages=True):
                    chains.append(chain)
        return ContractCheck(kept=not chains, metadata={"chains": chains})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print each chain on a line."""
        for chain in check.metadata["chains"]:
            output.print_error(" -> ".join(chain))

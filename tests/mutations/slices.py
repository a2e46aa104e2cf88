"""Which cells of a notebook another one needs, by the names that they bind and use.

A cell is needed if it binds a name that is used later on the way, or changes the thing that has the name by
an assignment to its parts (`a[0] = 1`, `a.x = 1`) or by a call of its method (`a.append(1)`). What a cell
does to the arguments of a function is not seen, so who runs a slice must see that the cell, unchanged, passes
in it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence

INNER = (ast.FunctionDef, ast.ClassDef, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


def root(node: ast.AST) -> str | None:
    """The name at the root of `name.part[index]...`."""
    while isinstance(node, (ast.Attribute, ast.Subscript, ast.Starred)):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


def uses(tree: ast.AST) -> set[str]:
    """All names that are used somewhere, in functions, too."""
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def outside(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a cell that are not inside of a function, class or comprehension."""
    for node in ast.iter_child_nodes(tree):
        yield node
        if not isinstance(node, INNER):
            yield from outside(node)


def imported(trees: Iterable[ast.Module]) -> set[str]:
    """The names that imports bind."""
    nodes = [
        node for tree in trees for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))
    ]
    return {(alias.asname or alias.name).split(".")[0] for node in nodes for alias in node.names}


def binds(tree: ast.Module, modules: set[str]) -> set[str]:
    """The names that a cell binds, and those whose things it changes, modules excepted."""
    found: set[str | None] = set(imported([tree]))
    for node in outside(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
        elif isinstance(node, (ast.Name, ast.Attribute, ast.Subscript)) and not isinstance(
            node.ctx, ast.Load
        ):
            found |= {root(node)} - modules
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            if isinstance(node.value.func, ast.Attribute):
                found |= {root(node.value.func)} - modules
    return {name for name in found if name}


def needed(sources: Sequence[str], targets: Iterable[int]) -> set[int]:
    """The numbers of the target cells and of all cells that they need."""
    trees = [ast.parse(source) for source in sources]
    modules = imported(trees)
    bound = [binds(tree, modules) for tree in trees]
    chosen: set[int] = set()
    for target in targets:
        names, here = uses(trees[target]), {target}
        for number in range(target - 1, -1, -1):
            if bound[number] & names:
                here.add(number)
                names |= uses(trees[number])
        chosen |= here
    return chosen

"""The models as C99: `code` writes a graph, `interface` names what is written, `export` is the recipe."""

"""The numbers of the theory's sections 2, 3 and 5, recomputed: by the product where it can, else by the reference."""

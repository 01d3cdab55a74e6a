"""Changes of the scenario in words, for everybody who tells of them."""

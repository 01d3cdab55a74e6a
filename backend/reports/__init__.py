"""Reports: simulations drawn and judged, as files that are read without this program."""

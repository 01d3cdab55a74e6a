"""Batches: thousands of runs of one scenario, computed part by part, kept in files and taken up again after a stop."""

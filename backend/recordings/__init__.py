"""Recordings: every run of the live session as an MCAP file, written beside the loop, read, compared and taken home."""

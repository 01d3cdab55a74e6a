"""Migrations of the database, run by backend.store.migrating."""

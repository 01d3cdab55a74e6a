"""The database: tables and their migrations, versioned documents, single kept values; its troubles told as problems."""

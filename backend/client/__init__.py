"""Scripts and notebooks against a running server: needs the standard library and pyarrow, and nothing of the server."""

from backend.client.client import VsseaClient
from backend.client.problem import VsseaError

__all__ = ["VsseaClient", "VsseaError"]

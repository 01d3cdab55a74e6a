"""Folders that a kill has left between making or deleting a batch and telling the database of it.

Results that were not to be deleted are never removed: the database that names them may only be away.
"""

import logging
import re
from pathlib import Path

from backend.batch.folder import DELETED, BatchFolder

logger = logging.getLogger(__name__)
ID = re.compile(r"\d{8}-\d{6}-\d{3}-[0-9a-f]{6}")


def sweep(folder: Path, known: set[str]) -> None:
    """Remove what was left half made or half deleted in the folder of all batches; `known` are their ids. Raises OSError."""
    for path in [*folder.iterdir()] if folder.is_dir() else []:
        name = path.name.removesuffix(DELETED)
        if ID.fullmatch(name) and path.is_dir():
            _see_to(BatchFolder(path), path.name != name, name in known)


def _see_to(batch: BatchFolder, was_to_be_deleted: bool, is_known: bool) -> None:
    if is_known:
        if was_to_be_deleted:
            batch.renamed("")
            logger.info("%s was not deleted: its batch is still in the database", batch.path)
    elif not batch.has_only_its_own():
        logger.warning("%s is left as it is: no batch names it, but it holds files of others", batch.path)
    elif was_to_be_deleted or not batch.parts():
        batch.delete()
        logger.info("%s was left half made or half deleted, and is removed", batch.path)
    else:
        logger.warning(
            "%s holds results that no batch of the database names; remove it, or bring the database back", batch.path
        )

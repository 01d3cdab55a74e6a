"""Reports as the workers write them: into a folder of their own, told by its name."""

import json
import tempfile

from backend.compute.worker import Progress


def paper_task(folder: str, progress: Progress) -> bytes:
    """Write the paper's report into a new folder below `folder`; return its claims and where it is, as JSON."""
    from backend.reports.paper import paper_report  # brings in the drawing library, which no other job needs

    target = tempfile.mkdtemp(prefix="paper-", dir=folder)
    report = paper_report(target, progress)
    return json.dumps({"kind": "paper", "folder": target, "report": report}, ensure_ascii=False).encode()

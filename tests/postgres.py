"""A PostgreSQL server of its own for tests: started from the programs on this machine, in a temporary folder, and ended."""

import importlib.util
import os
import pwd
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from tests.backend.server import until

START_LIMIT_S = 60.0
USER = "postgres"
PROGRAMS = ("initdb", "postgres", "createdb", "pg_isready")


def find_postgres() -> Path | None:
    """The folder of the server's programs, None if they or their driver are not here."""
    if importlib.util.find_spec("psycopg") is None:
        return None
    if not _may_run():
        return None
    found = shutil.which("postgres")
    folders = [
        *sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True),
        *([Path(found).resolve().parent] if found else []),
    ]
    return next((folder for folder in folders if all((folder / program).exists() for program in PROGRAMS)), None)


class PostgresServer:
    """One server without a port: it listens on a socket in its folder."""

    def __init__(self, programs: Path) -> None:
        self._programs = programs
        self.folder = Path(tempfile.mkdtemp(prefix="vssea-postgres-", dir="/tmp"))
        if os.getuid() == 0:
            shutil.chown(self.folder, USER)
        self._run("initdb", "--auth=trust", "--no-sync", f"--username={USER}", "-D", str(self.folder / "data"))
        options = ["-c", "listen_addresses=", "-k", str(self.folder), "-c", "fsync=off"]
        self.process = subprocess.Popen(
            [self._programs / "postgres", "-D", self.folder / "data", *options],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=_unprivileged(), cwd=self.folder,
        )  # fmt: skip
        try:
            self._wait()
        except BaseException:
            self.stop()
            raise

    def new_database(self, name: str) -> str:
        """Make an empty database and return its address."""
        self._run("createdb", "-h", str(self.folder), "-U", USER, name)
        return f"postgresql://{USER}@/{name}?host={self.folder}"

    def stop(self) -> None:
        """End it and remove its folder."""
        self.process.terminate()
        try:
            self.process.wait(20.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder)

    def _wait(self) -> None:
        until(self._listens, START_LIMIT_S)

    def _listens(self) -> bool:
        if self.process.poll() is not None:
            raise RuntimeError("the PostgreSQL server ended")
        asked = subprocess.run([self._programs / "pg_isready", "-q", "-h", self.folder], check=False)
        return asked.returncode == 0

    def _run(self, program: str, *arguments: str) -> None:
        subprocess.run(
            [self._programs / program, *arguments],
            check=True,
            capture_output=True,
            preexec_fn=_unprivileged(),
            cwd=self.folder,
        )


def _may_run() -> bool:
    """A server refuses to run as root: then the user that the package made is needed."""
    if os.getuid() != 0:
        return True
    try:
        pwd.getpwnam(USER)
    except KeyError:
        return False
    return True


def _unprivileged() -> Callable[[], None] | None:
    if os.getuid() != 0:
        return None
    user = pwd.getpwnam(USER)

    def become() -> None:
        os.setgroups([])
        os.setgid(user.pw_gid)
        os.setuid(user.pw_uid)

    return become

"""Settings of the server, as data: one list of name, default and help; environment variables VSSEA_... set them."""

import re
from pathlib import Path

import platformdirs
from pydantic import Field, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from vssea_core.scenarios import SCENARIOS

DATABASES = ("sqlite:///", "postgresql://", "postgresql+psycopg://")
SCHEDULER = re.compile(r"[a-z]+://[^\s/]+:\d+/?")
LOOPBACK = ("127.0.0.1", "localhost", "::1")


class Settings(BaseSettings):
    """What a server can be told; every field is documented in docs/settings.md."""

    model_config = SettingsConfigDict(env_prefix="VSSEA_", frozen=True)

    host: str = Field("127.0.0.1", description="Address to listen on; other than loopback needs a token.")
    port: int = Field(8000, ge=1, le=65535, description="Port to listen on.")
    token: str | None = Field(None, min_length=16, description="Secret that callers must give; needed beyond loopback.")
    allowed_hosts: tuple[str, ...] = Field((), description="Further names this server may be called by (Host header).")
    data_dir: Path = Field(
        Path(platformdirs.user_data_dir("vssea")),
        description="Where the database, recordings and files of rigs are kept.",
    )
    database: str | None = Field(
        None,
        description="Where presets, actuators and the catalogue of recordings are kept: a SQLite or PostgreSQL URL.",
    )
    scenario: str = Field("nominal", description="Scenario of the live session at the first start.")
    scene: bool = Field(True, description="Whether the 3D scene runs.")

    recording: bool = Field(True, description="Whether the live session is recorded.")
    recordings_dir: Path | None = Field(
        None, description="Where recordings are kept; `recordings` in the data folder if unset."
    )
    recordings_quota_gb: float = Field(
        10.0, gt=0.0, description="Most that recordings take; the oldest go first, starred ones never."
    )
    recordings_keep_free_gb: float = Field(
        0.5, ge=0.0, description="Recording stops when the disk has less than this left."
    )
    recording_part_minutes: float = Field(60.0, gt=0.0, description="A longer run is recorded in parts of this length.")

    batches_dir: Path | None = Field(
        None, description="Where batches and their results are kept; `batches` in the data folder if unset."
    )
    batch_workers: int | None = Field(
        None, ge=1, le=1024, description="Processes that compute batches; as many as the machine has cores if unset."
    )
    batch_most_runs: int = Field(1_000_000, ge=1, le=10_000_000, description="Most runs that a batch may have.")
    batch_most_gb: float = Field(20.0, gt=0.0, description="Most that the results of one batch may take.")
    batch_waiting: int = Field(16, ge=1, le=1000, description="Most batches that may wait for their turn.")
    batch_engine: str | None = Field(
        None, description="Where batches are computed: the address of a Dask scheduler; this machine if unset."
    )

    @field_validator("scenario")
    @classmethod
    def _known_scenario(cls, name: str) -> str:
        if name not in SCENARIOS:
            raise ValueError(f"{name!r} is not a ready scenario; expected one of {', '.join(SCENARIOS)}")
        return name

    @field_validator("database")
    @classmethod
    def _known_database(cls, url: str | None) -> str | None:
        if url is not None and not url.startswith(DATABASES):
            # The value is not repeated: it may hold a password.
            raise ValueError(
                "is no address of a database; expected sqlite:////folder/file.sqlite or postgresql://user:password@host/name"
            )
        return url

    @field_validator("batch_engine")
    @classmethod
    def _known_engine(cls, address: str | None) -> str | None:
        if address is not None and not SCHEDULER.fullmatch(address):
            raise ValueError(f"{address!r} is no address of a Dask scheduler; expected such as tcp://127.0.0.1:8786")
        return address

    @model_validator(mode="after")
    def _token_beyond_loopback(self) -> "Settings":
        if self.host not in LOOPBACK and self.token is None:
            raise ValueError(
                f"host {self.host} is not loopback and no token is set; "
                "set VSSEA_TOKEN to at least 16 characters, or listen on 127.0.0.1"
            )
        return self

    @property
    def recordings_folder(self) -> Path:
        """Folder of the recordings."""
        return self.recordings_dir or self.data_dir / "recordings"

    @property
    def batches_folder(self) -> Path:
        """Folder of the batches."""
        return self.batches_dir or self.data_dir / "batches"

    @property
    def rigs_folder(self) -> Path:
        """Folder of the rigs' files."""
        return self.data_dir / "rigs"

    @property
    def database_url(self) -> str:
        """Address of the database: a file in the data folder unless another one is named."""
        return self.database or f"sqlite:///{self.data_dir / 'vssea.sqlite'}"

    @property
    def hosts(self) -> frozenset[str]:
        """Host names (without port) that this server answers to."""
        own = () if self.host in ("0.0.0.0", "::") else (self.host,)
        return frozenset((*LOOPBACK, *own, *self.allowed_hosts))

import pytest

from tests.chromium import find_chromium


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    """The backend runs on asyncio (uvicorn), so do its tests."""
    return "asyncio"


@pytest.fixture(scope="session")
def chromium_path() -> str:
    """The browser that `make test` found or installed."""
    path = find_chromium()
    if path is None:
        pytest.fail("No Chromium found: run `make test`, which installs one, or set CHROMIUM to its path.")
    return path

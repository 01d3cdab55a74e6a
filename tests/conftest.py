import pytest
from hypothesis import settings

from tests.chromium import find_chromium
from tests.compiler import find_compiler

# How long an example takes says something of the machine, not of the law.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what computes batches: `make test` has it follow the browser's tests, so that both halves take about as long."""
    for item in items:
        if item.path.parent.name == "backend" and item.path.name.startswith(("test_batch", "test_client", "test_dask")):
            item.add_marker("batches")


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


@pytest.fixture(scope="session")
def c_compiler() -> str:
    """The C compiler that `make test` found or installed."""
    path = find_compiler()
    if path is None:
        pytest.fail("No C compiler found: run `make test`, which installs one, or set CC to its path.")
    return path

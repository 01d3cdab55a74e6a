"""The client against a real server: the numbers that the same runs have here, to the bit."""

import numpy as np
import pytest

from backend.client import VsseaClient, VsseaError
from tests.backend.server import Server
from vssea_core.batch.document import Batch, Grid, Keep
from vssea_core.batch.part import run_part
from vssea_core.batch.plan import BatchPlan
from vssea_core.channels import CHANNELS
from vssea_core.scenarios import REALISTIC
from vssea_core.simulation.metrics import metrics
from vssea_core.simulation.run import simulate

PATIENCE_S = 300.0  # the kernels may have to be compiled first
BATCH = Batch(
    scenario=REALISTIC.model_copy(update={"duration_s": 0.2}),
    vary=(Grid(path="actuator.link.inertia", low=0.5, high=2.0, count=20, factor=True),),
    keep=Keep(trajectories="all", every=20),
)


def test_a_batch_comes_home_with_the_bits_that_it_has_here(server: Server) -> None:
    client = VsseaClient(server.url)
    assert client.batches.estimate(BATCH)["runs"] == 20
    started = client.batches.create(BATCH, key="client")
    assert client.batches.create(BATCH, key="client")["id"] == started["id"]
    shares: list[float] = []
    ended = client.batches.wait(
        started["id"], progress=lambda now: shares.append(now["progress"]["share"]), every_s=0.05, limit_s=PATIENCE_S
    )
    assert (ended["state"], shares[-1]) == ("done", 1.0)
    expected = run_part(BatchPlan(BATCH), 0, 20)
    assert expected is not None
    for table, columns in (
        (client.batches.results(started["id"]), expected.rows),
        (client.batches.trajectories(started["id"]), expected.trajectories),
    ):
        assert table.to_pydict() == {name: [*column] for name, column in columns.items()}
    assert client.batches.run(started["id"], 7)["rms_error"] == expected.rows["rms_error"][7]
    alone = simulate(BatchPlan(BATCH).scenario(7))
    again = client.batches.simulate(started["id"], 7)
    assert again.column_names == [channel.name for channel in CHANNELS]
    assert np.array_equal(np.array([*again.to_pydict().values()]).T, alone.rows, equal_nan=True)
    assert client.metrics(client.batches.scenario(started["id"], 7))["metrics"] == metrics(alone.rows)
    client.batches.delete(started["id"])
    with pytest.raises(VsseaError) as gone:
        client.batches.get(started["id"])
    assert gone.value.status == 404


def test_a_refusal_is_the_servers_sentence(server: Server) -> None:
    wrong = {"vary": [{"kind": "grid", "path": "tuning.observer.bandwith", "low": 1.0, "high": 2.0}]}
    with pytest.raises(VsseaError, match=r"nearest: tuning\.observer\.bandwidth") as refused:
        VsseaClient(server.url).batches.create(wrong)
    assert refused.value.status == 422

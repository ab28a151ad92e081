"""Stored states of a slave with a right checksum and wrong content are refused in words, and the slave lives on."""

import json
import zlib

import numpy as np
import pytest
from tlismni.core.errors import TlismniError
from tlismni.fmu_wrapper.errors import SnapshotError
from tlismni.fmu_wrapper.snapshot import LENGTHS, MAGIC


def parts_of(data):
    start = len(MAGIC) + LENGTHS
    lengths = [int.from_bytes(data[i : i + 8], "little") for i in range(len(MAGIC), start - 8, 8)]
    head, values, state = (data[start + sum(lengths[:k]) : start + sum(lengths[: k + 1])] for k in range(3))
    return json.loads(head), values, state


def joined(head, values, state):
    parts = (json.dumps(head).encode(), values, state)
    numbers = [*(len(part) for part in parts), zlib.crc32(b"".join(parts))]
    return MAGIC + b"".join(n.to_bytes(8, "little") for n in numbers) + b"".join(parts)


@pytest.fixture
def stored(fake_slave):
    slave = fake_slave(variant="b", light=True)
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.25)
    return slave, slave.snapshot().data


def refused(slave, data):
    before = slave.snapshot().data
    with pytest.raises(SnapshotError) as caught:
        slave.restore(slave.snapshot_from_bytes(data))
    assert len(str(caught.value)) > 40 and slave.snapshot().data == before


@pytest.mark.sampled(30)
@pytest.mark.parametrize("name", ["phase", "start_time", "stop_time", "time", "applied", "identity", "format"])
@pytest.mark.parametrize("value", ["x", -1e9, True, [], [[1.0, 2.0]], {"a": 1}, float("nan"), 10**400, "failed"])
def test_heads(stored, name, value):
    slave, data = stored
    head, values, state = parts_of(data)
    if name == "start_time" and value == -1e9:
        pytest.skip("a start that may have been")
    refused(slave, joined({**head, name: value}, values, state))
    refused(slave, joined({k: v for k, v in head.items() if k != name}, values, state))


def test_values(stored):
    """A not-a-number in each real that can be set, an index beyond each enumeration, a byte that is no boolean."""
    slave, data = stored
    head, values, state = parts_of(data)
    table = slave.variables
    reals, integers = len(table.of_kind["real"]), len(table.of_kind["integer"])
    for i, variable in enumerate(table.of_kind["real"]):
        if variable.role != "output":
            changed = np.frombuffer(values, "<f8", reals).copy()
            changed[i] = np.nan
            refused(slave, joined(head, changed.tobytes() + values[8 * reals :], state))
    for i, variable in enumerate(table.of_kind["integer"]):
        if variable.role != "output" and variable.items:
            changed = np.frombuffer(values, "<i4", integers, 8 * reals).copy()
            for value in (-1, len(variable.items), 2**31 - 1):
                changed[i] = value
                rest = values[8 * reals + 4 * integers :]
                refused(slave, joined(head, values[: 8 * reals] + changed.tobytes() + rest, state))
    at = 8 * reals + 4 * integers  # the first boolean, `solver.light` or an output
    refused(slave, joined(head, values[:at] + b"\x02" + values[at + 1 :], state))
    for cut in (values[:-1], values[:-40], b"", values + b"x", values[: values.rindex(b"[")] + b'["a", "b"]'):
        refused(slave, joined(head, cut, state))


def test_nothing_may_follow_or_be_missing(stored):
    slave, data = stored
    head, values, _ = parts_of(data)
    refused(slave, data + b"\0")
    refused(slave, data + bytes(4096))
    refused(slave, joined(head, values, b""))
    refused(slave, data[:-3])
    refused(slave, data[: len(MAGIC)] + b"\xff" * 32 + data[len(MAGIC) + 32 :])
    slave.restore(slave.snapshot_from_bytes(data))
    slave.do_step(0.25, 0.25)
    assert isinstance(slave["ball.y"], float)


def test_random_bytes_are_refused_or_taken_but_end_nothing(stored):
    slave, data = stored
    rng = np.random.default_rng(1)
    head, values, state = parts_of(data)
    for _ in range(300):
        changed = bytearray(values)
        for place in rng.integers(len(changed), size=3):
            changed[place] = rng.integers(256)
        try:
            slave.restore(slave.snapshot_from_bytes(joined(head, bytes(changed), state)))
        except TlismniError:
            slave.restore(slave.snapshot_from_bytes(data))

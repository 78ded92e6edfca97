# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the node publishes, as ekf.launch.py starts it, is what the filter needs."""

from pathlib import Path

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.protocol.integrity import Integrity
import numpy as np
import pytest
from support.devices import DEEP, Device, SAFE
from support.launched import install_filter, StandIn
from support.processes import listening, running
from support.robot_localization import Filter, sources
import yaml

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = 600


def health(index):
    """Return the health of a sample: one signal after the other is at risk, then unavailable."""
    states = [[Integrity.SAFE] * 11 for _ in range(2)]
    for row, state in zip(states, (Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE)):
        row[index // 40 % 11] = state
    row = states[index // 20 % 2]
    return (SAFE, SAFE[:5]) if index < 40 else (tuple(row[:6]), tuple(row[6:]))


@pytest.fixture
def words(tmp_path, monkeypatch, cable):
    """Return the command line of the driver."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(install_filter(tmp_path)))
    (driver, _), _ = StandIn().run(StandIn().include('ekf', {'port': cable.path}))
    monkeypatch.undo()
    return driver.words


def test_the_filter_takes_what_the_node_publishes(cable, words):
    """It finds frames, covariances and stamps, and no NaN, and uses each topic."""
    given = yaml.safe_load((ROOT / 'config/ekf.yaml').read_text())['/**']['ros__parameters']
    inputs = sources(given)
    deep = [word for name, value in DEEP.items() for word in ('-p', f'{name}:={value}')]
    with listening({source.topic: TOPICS[source.topic] for source in inputs}) as ear, \
            running('driver_node', *words, *deep), Device(cable, health=health):
        ear.wait('imu/data', SAMPLES // 2)
        messages = {source: list(ear.messages[source.topic]) for source in inputs}
    model = Filter(given, {'imu_link': (np.zeros(3), np.eye(3))})
    for source, received in messages.items():
        for message in received:
            model.take(source, message)
    assert model.problems == set()
    assert len(model.used) == 4 and min(model.used.values()) > 200

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the file for diagnostic_aggregator: it takes every status of every driver, once."""

from pathlib import Path

from bahrs_driver.diagnostics.names import node_label, status_name
import pytest
import yaml

FILE = Path(__file__).resolve().parents[2] / 'config/diagnostic_aggregator.yaml'
TASKS = ('Link', 'Framing', 'Time', 'Rates', 'Integrity', 'Requests', 'Device', 'Publishing')


def analyzers():
    """Return the analyzers of the driver, by name."""
    parameters = yaml.safe_load(FILE.read_text())['analyzers']['ros__parameters']
    return parameters['bahrs_driver']['analyzers']


@pytest.mark.parametrize('namespace', ['/', '/left', '/uav/right'])
@pytest.mark.parametrize('qualified', [False, True])
@pytest.mark.parametrize('task', TASKS)
def test_every_status_has_one_analyzer(task, namespace, qualified):
    """An analyzer takes a name that contains one of its texts."""
    name = status_name(node_label('bahrs_driver', namespace, qualified), task)
    takers = [key for key, analyzer in analyzers().items()
              if any(text in name for text in analyzer['contains'])]
    assert len(takers) == 1


def test_other_nodes_are_left_alone():
    """Though their tasks may have the same names."""
    assert not any(text in 'camera: Link' for analyzer in analyzers().values()
                   for text in analyzer['contains'])

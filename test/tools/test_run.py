# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`make run`, without make."""

import os
from pathlib import Path
import signal
import subprocess
import sys

from bahrs_driver.convert.bahrs.converter import TOPICS
import pytest
from support.processes import BIN, listening, PATIENCE, wait_for

RUN = Path(__file__).parents[2] / 'tools' / 'run.py'


pytestmark = pytest.mark.skipif(
    not (BIN / 'bahrs').exists(), reason='it runs what is installed')


def ran(*words):
    """Return exit status and standard error of a run."""
    done = subprocess.run([sys.executable, str(RUN), *words], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False)
    return done.returncode, done.stderr


@pytest.mark.parametrize(('words', 'status', 'sentence'), [
    (('--port', '/dev/nowhere', '--duration', '2'), 1, 'bahrs monitor: no data arrived: '),
    (('--port', '/dev/null', '--duration', '2'), 1, 'bahrs monitor: no data arrived: '),
    (('--duration', '0'), 1, 'bahrs monitor: no data arrived: '),
    (('--sensor', 'nothing'), 2, "argument --sensor: invalid choice: 'nothing'"),
    (('--duration', 'long'), 2, "argument --duration: invalid float value: 'long'"),
    (('--port', 'foo://bar'), 1, 'parameter port'),
])
def test_without_data(words, status, sentence):
    """It fails, with one sentence that says why."""
    found, complaint = ran(*words)
    assert (found, complaint.count('Traceback')) == (status, 0), complaint
    assert sentence in complaint.splitlines()[-1]


@pytest.mark.slow
def test_with_data():
    """It ends well."""
    status, complaint = ran('--duration', '15')
    assert status == 0, complaint


def test_ctrl_c_ends_all_of_it():
    """Sent as terminals do, to all of the group, whether the view is there yet or not."""
    with listening(TOPICS) as ear:
        child = subprocess.Popen([sys.executable, str(RUN)], stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, text=True, start_new_session=True)
        try:
            ear.wait('imu/data_raw')
            os.killpg(child.pid, signal.SIGINT)
            text, _ = child.communicate(timeout=PATIENCE)
        finally:
            if child.poll() is None:
                child.terminate()       # it ends its children itself
                child.wait(PATIENCE)
        assert child.returncode == 0, text
        assert 'Traceback' not in text
        assert wait_for(lambda: not ear.node.count_publishers('imu/data_raw'))

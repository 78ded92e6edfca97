# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`make run`, without make."""

import os
from pathlib import Path
import signal
import subprocess
import sys

from bahrs_driver.convert.bahrs import TOPICS
from processes import BIN, listening, PATIENCE, wait_for
import pytest

RUN = Path(__file__).parents[1] / 'tools' / 'run.py'


@pytest.mark.skipif(not (BIN / 'bahrs').exists(), reason='it runs what is installed')
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

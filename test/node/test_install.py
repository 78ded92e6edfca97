# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The package as colcon builds it: what `ros2 run` would start, on the recording."""

import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

from bahrs_driver.convert.bahrs.converter import TOPICS
import pytest
from support.processes import listening, Process, running, wait_for
from support.shared_files import shared_file

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope='module')
def prefix(tmp_path_factory):
    """Build the package with colcon and return the folder that it is installed in."""
    folder = tmp_path_factory.mktemp('colcon')
    colcon(folder, 'build', *bases(folder), '--event-handlers', 'console_direct+')
    return folder / 'install'


def bases(folder):
    """Return where colcon finds the package, and where it builds and installs it."""
    return ('--paths', ROOT, '--build-base', folder / 'build',
            '--install-base', folder / 'install')


def colcon(folder, *words):
    """Run colcon, which must succeed, and return what it prints."""
    path = f'{Path(sys.executable).parent}{os.pathsep}{os.environ["PATH"]}'
    program = shutil.which('colcon', path=path)
    if program is None:
        pytest.skip('there is no colcon to build with')
    done = subprocess.run(
        [program, '--log-base', folder / 'log', *words],
        cwd=folder, capture_output=True, text=True, check=False,
        env={name: value for name, value in os.environ.items()
             if name not in ('AMENT_PREFIX_PATH', 'PYTHONDONTWRITEBYTECODE')})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_files_are_where_ros_looks_for_them(prefix):
    """Both executables, the marker of the package index, its launch file and parameters."""
    base = prefix / 'bahrs_driver'
    for name in ('lib/bahrs_driver/driver_node', 'lib/bahrs_driver/bahrs',
                 'share/ament_index/resource_index/packages/bahrs_driver',
                 'share/bahrs_driver/package.xml', 'share/bahrs_driver/launch/bahrs.launch.py',
                 'share/bahrs_driver/config/bahrs.yaml',
                 'share/bahrs_driver/launch/titan_m.launch.py',
                 'share/bahrs_driver/config/titan_m.yaml',
                 'share/bahrs_driver/launch/two_devices.launch.py',
                 'share/bahrs_driver/rviz/bahrs.rviz',
                 'share/bahrs_driver/urdf/bahrs.urdf.xacro'):
        assert (base / name).is_file(), name


def test_colcon_runs_the_tests(prefix):
    """Those that pytest finds: a few of them here, and their results are where colcon looks."""
    folder = prefix.parent
    few = sorted(str(path.relative_to(ROOT)) for path in (ROOT / 'test' / 'config').glob('*.py'))
    colcon(folder, 'test', *bases(folder), '--return-code-on-test-failure',
           '--pytest-args', *few)
    text = colcon(folder, 'test-result', '--test-result-base', folder / 'build', '--verbose')
    count = re.fullmatch(r'Summary: (\d+) tests, 0 errors, 0 failures, 0 skipped\n', text)
    assert count and int(count[1]) >= len(few), text


def test_built_node_publishes_the_recording(prefix, tmp_path):
    """With its parameter file, in a shell that has sourced the set-up."""
    link, part = str(tmp_path / 'port'), tmp_path / 'part.bin'
    part.write_bytes(shared_file('data/bahrs_recording_v2.bin').read_bytes()[:78_800])
    script = (f'export AMENT_PREFIX_PATH={sys.prefix}; . {prefix}/setup.bash; '
              f'exec {prefix}/bahrs_driver/lib/bahrs_driver/driver_node --ros-args '
              f'--params-file {prefix}/bahrs_driver/share/bahrs_driver/config/bahrs.yaml '
              f'-p port:={link}')
    with listening(TOPICS) as ear, running(
            'bahrs', 'replay', str(part), '--link', link, '--loop') as player:
        assert wait_for(lambda: player.lines)
        node = Process(['bash', '-c', script])
        try:
            ear.wait('imu/data_raw', 1000)
            assert ear.messages['imu/data_raw'][-1].linear_acceleration.z > 9.6
        finally:
            status = node.end()
    assert status == 0, node.text
    assert 'Traceback' not in node.text

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node on ports that are shared, odd, remote, or silent; what its user sees."""

import contextlib
import json
import os
import resource
import select
import socket
import stat
import subprocess
import sys
import time

from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from sensor_msgs.msg import Imu
from support.devices import Device, DIAGNOSTICS, says, status
from support.processes import command, driver, listening, PATIENCE, Process, running, wait_for
from support.serial_servers import SERVERS

ERROR, OK = DiagnosticStatus.ERROR, DiagnosticStatus.OK
RAW = {'imu/data_raw': Imu}
# Another program that reads a port, and looks at no lock.
READER = """
import os, select, sys
port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
print(flush=True)
while True:
    select.select([port], [], [])
    try:
        os.read(port, 4096)
    except BlockingIOError:
        pass
"""


@contextlib.contextmanager
def another_reader(path):
    """Let another program read a port."""
    with subprocess.Popen([sys.executable, '-c', READER, path],
                          stdout=subprocess.PIPE) as reader:
        try:
            reader.stdout.readline()
            yield reader
        finally:
            reader.kill()


@pytest.mark.slow
@pytest.mark.parametrize('first', ['driver', pytest.param('reader')])
def test_another_program_that_reads_the_port_is_reported_once(cable, first):
    """By name, in any order of start; the port stays open, and the remaining data is published."""
    if first == 'driver' and os.geteuid() != 0:
        pytest.skip('the kernel keeps an ordinary user out')
    with contextlib.ExitStack() as stack:
        if first == 'reader':
            reader = stack.enter_context(another_reader(cable.path))
        ear = stack.enter_context(listening({**DIAGNOSTICS, **RAW}))
        node = stack.enter_context(driver(cable.path))
        stack.enter_context(Device(cable))
        if first == 'driver':
            ear.wait('imu/data_raw', 10)
            reader = stack.enter_context(another_reader(cable.path))
        assert says(ear, 'Link', ERROR, f'process {reader.pid}'), status(ear, 'Link')
        assert f'"fuser -v {cable.path}" lists all' in status(ear, 'Link').message
        assert wait_for(lambda: 'another program is reading' in node.text), node.text
        ear.wait('imu/data_raw', len(ear.messages['imu/data_raw']) + 20)
        assert sum('is open' in line for line in node.lines) == 1, node.text
        assert sum('another program' in line for line in node.lines) == 1, node.text
        assert 'is gone' not in node.text
        reader.kill()
        assert says(ear, 'Link', OK, 'is open')
        assert wait_for(lambda: 'is in order again' in node.text)


def test_a_program_that_takes_all_is_named_beside_the_silence(cable):
    """The driver would otherwise look at power and cable."""
    with another_reader(cable.path) as reader, listening(DIAGNOSTICS) as ear, \
            driver(cable.path):
        assert says(ear, 'Link', ERROR, f'process {reader.pid}')
        assert 'is open but silent' in status(ear, 'Link').message


@pytest.mark.parametrize('kind', SERVERS)
def test_a_serial_server(kind):
    """Data flows, its end is noticed, and the driver connects again."""
    with socket.create_server(('127.0.0.1', 0)) as made, listening(RAW) as ear:
        made.settimeout(PATIENCE)
        with driver(f'{kind}://127.0.0.1:{made.getsockname()[1]}') as node:
            for turn in range(2):
                server = SERVERS[kind](made.accept()[0])
                before = len(ear.messages['imu/data_raw'])
                with Device(ServedPort(server)):
                    ear.wait('imu/data_raw', before + 50)
                server.close()
                assert wait_for(lambda: node.text.count('is gone: the ') == turn + 1), node.text
            assert node.end() == 0
    assert 'Traceback' not in node.text


def test_a_server_that_hangs_up_on_all_is_reported_once():
    """Such as one whose only connection is taken; it may send a message first."""
    with socket.create_server(('127.0.0.1', 0)) as made:
        made.settimeout(PATIENCE)
        with driver(f'socket://127.0.0.1:{made.getsockname()[1]}') as node:
            for _ in range(6):
                connection, _ = made.accept()
                connection.sendall(b'Port already in use\r\n')
                connection.close()
            assert wait_for(lambda: 'is gone: the other end closed' in node.text)
            assert len(node.lines) == 2, node.text


class ServedPort:
    """A serial server as the line of a Device."""

    is_open = True

    def __init__(self, server):
        """Send over it."""
        self.write = server.send


# Text of a port, and a part of the one sentence with which the start ends, or '' if the node
# goes on and tries.
ODD_PORTS = [
    ('hwgrep://(', 'is not a regular expression'),
    ('spy:///dev/null?file=x', 'spy:// is not supported'),
    ('socket://nowhere', 'a host and a port'),
    ('/dev/tty\x1b[2J\nUSB0', ''),
    ('/dev/' + 'x' * 3000, ''),
    (b'/dev/tty\xff\xfe'.decode(errors='surrogateescape'), ''),
    ('/', ''),
    ('hwgrep://no such device', ''),
]


@pytest.mark.parametrize('text, sentence', ODD_PORTS)
def test_odd_ports(text, sentence):
    """One printable line each; no traceback, no escape sequence, no forged line."""
    with running('driver_node', '--ros-args', '-p', f"port:='{text}'" if text == '' else
                 f'port:={text}') as node:
        if sentence:
            assert node.wait() == 1 and sentence in node.text
        else:
            assert wait_for(lambda: node.lines or not node.alive)
            status = node.end()
            assert status in (0, 1)
        lines = [line.rstrip('\n') for line in node.lines]
        assert all(line.isprintable() for line in lines) and 'Traceback' not in node.text
        assert len(lines) == 1, node.text


def test_a_port_name_forges_no_line_of_the_log(tmp_path):
    """It is one line, and so are the diagnostics."""
    path = f'{tmp_path}/port\n[INFO] [0.0] [other]: all is well\x1b[31m'
    with PtyPort(path) as port, listening(DIAGNOSTICS) as ear, \
            driver(json.dumps(path)) as node:
        shown = r'/port\x0a[INFO] [0.0] [other]: all is well\x1b[31m is open'
        assert wait_for(lambda: shown in node.text), node.text
        assert len(node.lines) == 1
        with Device(port):
            assert says(ear, 'Link', OK, shown)
        assert all(text.isprintable() for array in ear.messages['/diagnostics']
                   for item in array.status for text in
                   (item.message, item.hardware_id, *(pair.value for pair in item.values)))


# A start as an ordinary user, who may not enter the port's directory.
AS_NOBODY = """
import os, sys
from bahrs_driver.node import main as driver_node
import bahrs_driver.node.process
os.setgroups([]); os.setgid(65534); os.setuid(65534)
sys.exit(driver_node.main())
"""


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can become another user')
def test_a_directory_that_may_not_be_entered(tmp_path, monkeypatch):
    """The reading thread continues, and opens the port when that is possible."""
    folder = tmp_path / 'closed'
    folder.mkdir(mode=0o700)
    for parent in (*tmp_path.parents[:-2], tmp_path):
        parent.chmod(parent.stat().st_mode | stat.S_IXOTH)
    logs = tmp_path / 'log'
    logs.mkdir()
    logs.chmod(0o777)
    monkeypatch.setenv('ROS_LOG_DIR', str(logs))
    path = f'{folder}/port'
    node = Process([sys.executable, '-c', AS_NOBODY, '--ros-args', '-p', f'port:={path}'])
    try:
        with PtyPort(path) as port:
            os.chmod(port.path, 0o666)
            assert wait_for(lambda: f'may not enter {folder}' in node.text), node.text
            folder.chmod(0o755)
            assert wait_for(lambda: f'{path} is open' in node.text), node.text
        assert node.end() == 0 and 'Traceback' not in node.text
    finally:
        if node.alive:
            node.end()


def test_descriptors_beyond_those_of_select(cable):
    """A process that has many files open may start the driver."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard < 3000:
        pytest.skip(f'no more than {hard} files may be open here')
    code = ('import os, resource, sys\n'
            f'resource.setrlimit(resource.RLIMIT_NOFILE, (3000, {hard}))\n'
            'for _ in range(1100): os.set_inheritable(os.open("/dev/null", os.O_RDONLY), True)\n'
            'os.execv(sys.argv[1], sys.argv[1:])')
    node = Process([sys.executable, '-c', code, *command(
        'driver_node', '--ros-args', '-p', f'port:={cable.path}')])
    try:
        with listening(RAW) as ear, Device(cable):
            ear.wait('imu/data_raw', 50)
        assert node.end() == 0, node.text
    finally:
        if node.alive:
            node.end()


def test_a_titan_m_that_accepts_nothing(cable):
    """It is reported, and delays neither the reader nor the exit."""
    far_end = os.open(cable.path, os.O_WRONLY | os.O_NOCTTY | os.O_NONBLOCK)
    room = select.poll()
    room.register(far_end, select.POLLOUT)
    while room.poll(500):               # ms; the system makes room again as it moves bytes on
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(far_end, bytes(1))
    os.close(far_end)
    with listening(DIAGNOSTICS) as ear, driver(cable.path, sensor='titan_m') as node:
        assert says(ear, 'Requests', ERROR, 'does not take data: it has accepted nothing')
        assert says(ear, 'Link', ERROR, 'is open but silent')
        begin = time.monotonic()
        assert node.end() == 0, node.text
        assert time.monotonic() - begin < 10.0
        assert 'Traceback' not in node.text


def test_it_ends_while_it_connects():
    """A host that does not answer does not delay the exit; it is reported after 5 s."""
    with contextlib.ExitStack() as stack:
        deaf = stack.enter_context(socket.socket())
        deaf.bind(('127.0.0.1', 0))
        deaf.listen(0)
        for _ in range(3):              # once its queue is full, the kernel answers no more
            client = stack.enter_context(socket.socket())
            client.setblocking(False)
            client.connect_ex(deaf.getsockname())
        with driver(f'socket://127.0.0.1:{deaf.getsockname()[1]}') as node:
            assert wait_for(lambda: 'has not answered for 5 s' in node.text), node.text
            time.sleep(1.0)             # it connects again, after a pause of a tenth of a second
            begin = time.monotonic()
            assert node.end() == 0, node.text
            assert time.monotonic() - begin < 4.0
            assert len(node.lines) == 1, node.text

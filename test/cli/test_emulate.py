# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs emulate`: files in this process, ports in a child process."""

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time

from bahrs_driver.cli.main import main
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    EnterDiagnostics,
    Navigation,
    NvmPage,
    NvmReadRequest,
    SoftwareVersion,
)
from bahrs_driver.protocol.framing import Framer
import pytest
from support.waiting import PATIENCE, wait_for

MAIN = 'import sys; from bahrs_driver.cli.main import main; sys.exit(main())'
BYTES_PER_SECOND = 8680         # of version 3


@contextlib.contextmanager
def emulator(*words, start=()):
    """Run the verb with a control line, and end it at the end."""
    child = subprocess.Popen(
        [*start, sys.executable, '-c', MAIN, 'emulate', *words], stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1)
    try:
        yield child
    finally:
        if child.poll() is None:
            child.kill()
        child.communicate()


def finish(child, line='quit\n'):
    """End the emulator; return its exit status and its standard error."""
    _, error = child.communicate(line, timeout=PATIENCE)
    return child.returncode, error


class Reader:
    """A host at a port."""

    def __init__(self, path):
        """Open the port."""
        self._port = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self.framer, self.codec = Framer(BahrsFormat()), BahrsCodec()
        self.data, self.messages = b'', []

    def read(self):
        """Read the available bytes; return all messages so far."""
        with contextlib.suppress(BlockingIOError):
            data = os.read(self._port, 65536)
            self.data += data
            self.messages += [self.codec.decode(frame) for frame in self.framer.feed(data)]
        return self.messages

    def wait_for(self, condition):
        """Read until a message meets a condition, and return it."""
        assert wait_for(lambda: any(map(condition, self.read())))
        return next(filter(condition, self.messages))

    def send(self, request):
        """Send a request."""
        os.write(self._port, self.codec.encode(request, 3))

    def hung_up(self):
        """Return whether the port was removed."""
        poll = select.poll()
        poll.register(self._port)
        return any(event & select.POLLHUP for _, event in poll.poll(0))

    def close(self):
        """Close the port."""
        os.close(self._port)


@contextlib.contextmanager
def reading(path):
    """Open a port for the length of a block."""
    reader = Reader(path)
    try:
        yield reader
    finally:
        reader.close()


def to_file(path, *words):
    """Emulate into a file; return its bytes."""
    assert main(['emulate', '--output', str(path), *words]) == 0
    return path.read_bytes()


EVERYTHING = (
    '--duration', '8', '--sync-pulse-rate', '1', '--debug-rate', '5', '--drift-ppm', '30',
    '--wander-ppm', '1', '--fault', 'bit_flip=0.0005', '--fault', 'break=0.01', '--fault',
    'drop_frame=0.01', '--noise', 'attitude=0.001', '--bias', 'angular_rate=0.1,0,-0.1',
    '--latency-timer', '16')


def test_same_seed_same_bytes(tmp_path):
    """The same seed gives the same truth, too; another seed gives other bytes."""
    runs = [to_file(tmp_path / f'{index}.bin', '--truth', str(tmp_path / f'{index}.jsonl'),
                    '--seed', seed, *EVERYTHING) for index, seed in enumerate('778')]
    assert runs[0] == runs[1] != runs[2]
    assert (tmp_path / '0.jsonl').read_bytes() == (tmp_path / '1.jsonl').read_bytes()


def test_truth_marks_intact_frames(tmp_path, capsys):
    """Exactly the frames marked intact are in the bytes, and the report counts the same."""
    data = to_file(tmp_path / 'a.bin', '--truth', str(tmp_path / 'a.jsonl'), '--duration', '20',
                   '--fault', 'drop_frame=0.01', '--fault', 'bit_flip=0.0003',
                   '--fault', 'insert_byte=0.0003', '--fault', 'repeat_byte=0.0003')
    lines = [json.loads(line) for line in (tmp_path / 'a.jsonl').read_text().splitlines()]
    framer, codec = Framer(BahrsFormat()), BahrsCodec()
    messages = [codec.decode(frame) for frame in framer.feed(data) + framer.flush()]
    intact = [(line['message'], line.get('sequence')) for line in lines
              if line['wire'] == 'intact']
    assert [(message.NAME, getattr(message, 'sequence', None))
            for message in messages] == intact
    dropped = sum(line['wire'] == 'dropped' for line in lines)
    report = dict(line.rsplit(maxsplit=1) for line in capsys.readouterr().err.splitlines())
    assert dropped == int(report['dropped']) == int(report['drop_frame']) > 10


@pytest.mark.parametrize('version', ['1', '2', '3'])
@pytest.mark.parametrize('crc', ['word', 'byte'])
def test_versions_and_crc_orders(tmp_path, version, crc):
    """The stream has the requested version and CRC order."""
    data = to_file(tmp_path / 'a.bin', '--duration', '2', '--protocol-version', version,
                   '--crc', crc)
    frame_format = BahrsFormat()
    framer = Framer(frame_format)
    assert framer.feed(data) and framer.flush() == []
    assert (str(frame_format.version_seen), frame_format.order_seen) == (version, crc)


def test_a_scenario_from_a_file(tmp_path):
    """Commands run at their times; quit ends the emulator before the duration does."""
    (tmp_path / 'scenario').write_text('1 integrity all unavailable\n2 quit\n')
    data = to_file(tmp_path / 'a.bin', '--duration', '100', '--scenario',
                   str(tmp_path / 'scenario'))
    assert 8_000 < len(data) < 30_000


@pytest.mark.parametrize(('words', 'status', 'says'), [
    (['--output', 'x'], 1, 'needs --duration'),
    (['--output', '/nowhere/x', '--duration', '1'], 1, 'cannot write /nowhere/x: No such file'),
    (['--truth', '/nowhere/x'], 1, 'cannot write /nowhere/x'),
    (['--scenario', '/nowhere/x'], 1, 'cannot read /nowhere/x'),
    (['--nvm', '/nowhere/x'], 1, 'cannot read /nowhere/x'),
    (['--nvm', os.devnull], 2, 'an image has 8,000'),
    (['--link', os.curdir], 1, 'exists and is not a symbolic link'),
    (['--fault', 'rust=1'], 2, "no fault 'rust', only bit_flip"),
    (['--noise', 'force=1'], 2, "no quantity 'force', only specific_force"),
    (['--bias', 'attitude=1'], 2, '3 components, not 1'),
    (['--latency-timer', '900'], 2, 'from 1 to 255'),
    (['--duration', 'long'], 2, "a duration is 'long': it must be a number of at least 0"),
    (['--nvm-error-pages', '250'], 2, 'from 0 to 249'),
    (['--protocol-version', '4'], 2, 'invalid choice'),
])
def test_errors_are_one_sentence(capsys, words, status, says):
    """The sentence has the reason, and there is no traceback."""
    try:
        found = main(['emulate', *words])
    except SystemExit as stop:
        found = stop.code
    error = capsys.readouterr().err
    assert found == status and says in error and 'Traceback' not in error


def test_help_is_complete(capsys):
    """The help has all options, all faults and all commands."""
    with pytest.raises(SystemExit):
        main(['emulate', '--help'])
    text = capsys.readouterr().out
    for word in ('--sensor', '--protocol-version', '--crc', '--link', '--seed', '--duration',
                 '--motion', '--truth', '--output', '--time-label', '--drift-ppm',
                 '--sync-pulse-rate', '--latency-timer', '--fault', '--nvm', '--nvm-window',
                 'bit_flip', 'drop_frame', 'power-cycle', 'examples:', 'default: flight'):
        assert word in text


def test_a_device_on_a_port(tmp_path):
    """The device is paced, an invalid command ends nothing, and the link is removed at the end."""
    link = tmp_path / 'port'
    with emulator('--link', str(link), '--wait', '--seed', '3') as child:
        assert child.stdout.readline().strip() == str(link)
        with reading(link) as host:
            host.wait_for(lambda message: isinstance(message, SoftwareVersion))
            host.wait_for(lambda message: isinstance(message, Navigation))
            child.stdin.write('nonsense\nintegrity roll risk\n')
            host.wait_for(lambda message: isinstance(message, Navigation)
                          and message.health[2].label == 'integrity_risk')
            damaged = host.framer.counters.crc_failures
            status, error = finish(child)
        assert status == 0
        # A reader that is kept from reading for more than a second does lose some.
        assert damaged == 0 or 'bytes not read' in error
        assert "no command 'nonsense', only integrity" in error and 'Traceback' not in error
    assert not os.path.lexists(link)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_emulator(tmp_path, number):
    """The emulator ends with status 0 and removes its link."""
    link = tmp_path / 'port'
    with emulator('--link', str(link)) as child:
        assert child.stdout.readline()
        child.send_signal(number)
        status, error = finish(child, '')
        assert status == 0 and 'Traceback' not in error
    assert not os.path.lexists(link)


def test_an_ignored_hang_up_does_not_end_it(tmp_path):
    """After nohup the emulator continues."""
    with emulator(start=('sh', '-c', 'trap "" HUP; exec "$@"', 'sh')) as child:
        assert child.stdout.readline()
        child.send_signal(signal.SIGHUP)
        status, error = finish(child, 'nonsense\nquit\n')
        assert status == 0 and "no command 'nonsense'" in error


def test_it_ends_after_its_duration():
    """The emulator ends without a reader and without commands."""
    with emulator('--duration', '0.5') as child:
        assert child.stdout.readline().startswith('/dev/')
        status, error = finish(child, '')
        assert status == 0 and 'Traceback' not in error


def test_unplugged_and_back_under_the_same_link(tmp_path):
    """A reader loses the port, and finds it again."""
    link = tmp_path / 'port'
    with emulator('--link', str(link)) as child:
        child.stdout.readline()
        with reading(link) as host:
            host.wait_for(lambda message: isinstance(message, Navigation))
            child.stdin.write('unplug 3600\n')
            assert wait_for(lambda: not os.path.lexists(link))
            assert wait_for(host.hung_up)
        child.stdin.write('unplug 0\n')        # from now on
        assert child.stdout.readline().strip() == str(link)
        with reading(link) as host:
            host.wait_for(lambda message: isinstance(message, Navigation))
            assert not any(isinstance(message, SoftwareVersion) for message in host.messages)


def test_diagnostics_mode_over_the_port(tmp_path):
    """The device answers with a page of an image from a file."""
    image, link = bytes(index % 199 for index in range(8000)), tmp_path / 'port'
    (tmp_path / 'nvm').write_bytes(image)
    with emulator('--link', str(link), '--nvm', str(tmp_path / 'nvm')) as child:
        child.stdout.readline()
        with reading(link) as host:
            host.wait_for(lambda message: isinstance(message, Navigation))
            host.send(EnterDiagnostics())
            host.send(NvmReadRequest(5))
            page = host.wait_for(lambda message: isinstance(message, NvmPage))
            assert page == NvmPage(5, image[160:192])


@pytest.mark.parametrize(('mode', 'least', 'most'), [
    ('none', 0, 120), ('16', 100, 200), ('packets', 400, 600)])
def test_bursts_and_pace(tmp_path, mode, least, most):
    """The size of bursts fits the adapter, the rate fits the device."""
    link = tmp_path / 'port'
    with emulator('--link', str(link), '--latency-timer', mode) as child:
        child.stdout.readline()
        with reading(link) as host:
            host.wait_for(lambda message: isinstance(message, Navigation))

            def a_second_is_right():
                host.data, sizes, start = b'', [], time.monotonic()
                while time.monotonic() < start + 1.0:
                    before = len(host.data)
                    host.read()
                    if len(host.data) > before:
                        sizes.append(len(host.data) - before)
                    time.sleep(0.0002)
                return (len(host.data) == pytest.approx(BYTES_PER_SECOND, rel=0.1)
                        and least < sorted(sizes)[len(sizes) // 2] < most)

            # A machine that does much else hands bytes over late: in some second it does not.
            assert wait_for(a_second_is_right)

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The services that read the memory, on the node and the emulator as processes."""

import contextlib
import hashlib
import json
import os
from pathlib import Path
import pty
import signal
import subprocess
import time

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceBehavior
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Acknowledgement, EnterDiagnostics
from bahrs_driver.protocol.framing import Framer
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger
from support.devices import Device, DIAGNOSTICS, known, says, status, StoppableThread
from support.in_process import run_bahrs
from support.processes import command, driver, listening, PATIENCE, running, wait_for
from support.targets import EVERY_KIND, IMPOSSIBLE, REGULAR, snapshot

IMAGE = bytes((3 * index + index // 100) % 256 for index in range(8000))
# With this, each page comes so late that a dump takes ten seconds: time to come between.
SLOW = ('--latency-timer', '40')
SERVICES = {'nvm/read_page': Trigger, 'nvm/dump': Trigger, 'nvm/cancel': Trigger,
            'get_parameters': GetParameters, 'set_parameters': SetParameters}
HEARD = {**TOPICS, **DIAGNOSTICS, 'nvm/page': UInt8MultiArray}


class Services:
    """Calls services of the node."""

    def __init__(self, ear):
        """Create clients on the node of a listener."""
        self._clients = {name: ear.node.create_client(kind, f'/bahrs_driver/{name}')
                         for name, kind in SERVICES.items()}
        for client in self._clients.values():
            assert client.wait_for_service(PATIENCE)
        known(ear)

    def start(self, name, request=None):
        """Call a service and return the future."""
        return self._clients[name].call_async(request or SERVICES[name].Request())

    def call(self, name, request=None):
        """Call a service and return its response."""
        future = self.start(name, request)
        assert wait_for(future.done)
        return future.result()

    def change(self, name, value):
        """Set a parameter, and return the result."""
        kind = {int: ParameterType.PARAMETER_INTEGER, float: ParameterType.PARAMETER_DOUBLE,
                str: ParameterType.PARAMETER_STRING}[type(value)]
        field = {int: 'integer_value', float: 'double_value', str: 'string_value'}[type(value)]
        parameter = Parameter(name=name, value=ParameterValue(type=kind, **{field: value}))
        request = SetParameters.Request(parameters=[parameter])
        return self.call('set_parameters', request).results[0]

    def ask(self, name):
        """Call an nvm service and return success and content."""
        answer = self.call(f'nvm/{name}')
        return answer.success, json.loads(answer.message)


@pytest.fixture
def emulator(tmp_path):
    """Return a function that runs the emulator on tmp_path/port with more options."""
    image = tmp_path / 'image.bin'
    image.write_bytes(IMAGE)
    processes = []

    def start(*words):
        processes.append(running('bahrs', 'emulate', '--link', str(tmp_path / 'port'),
                                 '--nvm', str(image), *words))
        process = processes[-1].__enter__()
        assert wait_for(lambda: process.lines)
        return process

    yield start
    for process in processes:
        process.__exit__(None, None, None)


def test_read_page_and_dump(emulator, tmp_path):
    """Pages, file, SHA-256, topic; further requests meanwhile; then the stream is back."""
    emulator(*SLOW)
    file = tmp_path / 'dumps' / 'dump.bin'
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__page=7,
                                         nvm__directory=file.parent, nvm__dump_path=file.name):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert services.ask('read_page') == (True, {'page': 7, 'data': IMAGE[224:256].hex()})
        assert numbered(ear.wait('nvm/page')) == [(7, IMAGE[224:256])]
        assert services.change('nvm.page', 249).successful
        assert services.ask('read_page')[1]['data'] == IMAGE[-32:].hex()

        dump = services.start('nvm/dump')
        assert says(ear, 'Rates', DiagnosticStatus.STALE, 'diagnostics mode')
        assert services.ask('read_page') == (
            False, {'error': 'another NVM request is under way: wait for it, or cancel it',
                    'page': 249})
        names = GetParameters.Request(names=['port'])
        assert services.call('get_parameters', names).values
        assert not dump.done()
        assert 'reading' in {pair.key: pair.value
                             for pair in status(ear, 'Device').values}['NVM session']
        assert wait_for(dump.done)
        assert json.loads(dump.result().message) == {
            'path': str(file), 'bytes': 8000, 'sha256': hashlib.sha256(IMAGE).hexdigest()}
        assert file.read_bytes() == IMAGE and list(file.parent.iterdir()) == [file]
        assert numbered(ear.wait('nvm/page', 252))[2:] == [
            (number, IMAGE[32 * number:32 * number + 32]) for number in range(250)]

        ear.wait('imu/data', len(ear.messages['imu/data']) + 20)
        assert says(ear, 'Rates', DiagnosticStatus.OK, 'All messages at their rates')


def numbered(pages):
    """Return numbers and data of pages, from messages on nvm/page."""
    return [(int(page.layout.dim[0].label.removeprefix('page=')), bytes(page.data))
            for page in pages]


def test_failures_are_told_and_leave_no_file(emulator, tmp_path):
    """A page that cannot be read, and nothing to cancel; pages before it are published."""
    emulator('--nvm-error-pages', '9')
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__directory=tmp_path):
        services = Services(ear)
        ear.wait('imu/data', 10)
        before = set(tmp_path.iterdir())
        assert services.ask('dump') == (
            False, {'error': 'the device cannot read page 9 (status 255)'})
        assert set(tmp_path.iterdir()) == before
        assert [number for number, _ in numbered(ear.wait('nvm/page', 9))] == list(range(9))
        assert services.ask('cancel') == (False, {'error': 'no NVM request is under way'})
        ear.wait('imu/data', len(ear.messages['imu/data']) + 20)


def test_targets_that_are_refused(emulator, tmp_path):
    """All kinds, before the stream is stopped; the node survives, and the next dump succeeds."""
    emulator()
    root = tmp_path / 'dumps'
    root.mkdir()
    refused = [*(set(IMPOSSIBLE.values()) - {'target/'}), '~nosuchuser/x', '~/x',
               str(tmp_path / 'port'), '/dev/ttyUSB0', '../x', 'out/x']
    refused = [path for path in refused if path.isprintable()]      # or no text of ROS
    for kind, make in EVERY_KIND.items():
        make(root / kind)
        refused += [kind] if kind not in REGULAR else []
    (root / 'out').symlink_to(tmp_path)
    before = snapshot(tmp_path)
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__directory=root,
                                         nvm__dump_path="'~nosuchuser/x'") as node:
        services = Services(ear)
        ear.wait('imu/data', 10)
        for path in refused:
            assert services.change('nvm.dump_path', path).successful
            success, answer = services.ask('dump')
            assert not success and answer['error'].startswith('parameter nvm.dump_path: '), path
        assert snapshot(tmp_path) == before
        # Had the stream been stopped, pages would have come.
        assert not ear.messages['nvm/page']
        assert services.change('nvm.dump_path', 'regular').successful
        assert services.ask('dump')[0] and (root / 'regular').read_bytes() == IMAGE
        assert 'Traceback' not in node.text


@pytest.mark.parametrize('directory, sentence', [
    ('/proc/nowhere', 'cannot make /proc/nowhere: '),
    ("'~nosuchuser'", 'cannot write ~nosuchuser: '),
    ('/dev/null', 'cannot make /dev/null: '),
])
def test_a_directory_that_cannot_be_used(emulator, tmp_path, directory, sentence):
    """The node drives its device all the same."""
    emulator()
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__directory=directory):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert not services.change('nvm.directory', str(tmp_path)).successful
        success, answer = services.ask('dump')
        assert not success and answer['error'].startswith(f'parameter nvm.directory: {sentence}')


def test_parameters_are_read_at_each_call(emulator, tmp_path):
    """Timeout and kind of frames; invalid values are rejected."""
    emulator('--service-crc', 'mpeg2', '--nvm-window', 'always')
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__enter_timeout=600,
                                         nvm__service_frames='mpeg2'):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert services.ask('read_page')[0]
        for name, value in (('service_frames', 'crc64'), ('enter_timeout', 0.5),
                            ('enter_timeout', float('nan')), ('page', 250)):
            result = services.change(f'nvm.{name}', value)
            assert not result.successful and f'nvm.{name}' in result.reason
        assert services.change('nvm.service_frames', 'crc32').successful
        assert services.change('nvm.enter_timeout', 1.0).successful
        success, answer = services.ask('read_page')
        assert not success and 'within 1 s' in answer['error']
        assert services.change('nvm.service_frames', 'auto').successful
        assert services.ask('read_page')[0]


def test_a_device_that_agrees_and_goes_on_streaming(cable, tmp_path):
    """The service responds, and the node continues and ends normally."""
    codec, framer = BahrsCodec(), Framer(BahrsFormat())
    with listening(HEARD) as ear, driver(cable.path, nvm__directory=tmp_path) as node, \
            Device(cable):
        services = Services(ear)
        ear.wait('imu/data', 10)
        answer = services.start('nvm/dump')
        asked = 0
        while not answer.done() and asked < 1000:
            for frame in framer.feed(cable.read(0.01)):
                if isinstance(codec.decode(frame), EnterDiagnostics):
                    asked += 1
                    cable.write(codec.encode(Acknowledgement(EnterDiagnostics.TYPE, 0), 3))
        assert 'did not stay in it' in json.loads(answer.result().message)['error']
        assert asked < 100
        ear.wait('imu/data', len(ear.messages['imu/data']) + 20)
        assert node.end() == 0


def test_cancel_and_unplug(emulator, tmp_path):
    """During a dump; each time the stream comes back by itself."""
    device = emulator(*SLOW)
    file = tmp_path / 'dump.bin'
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__directory=tmp_path,
                                         nvm__dump_path=file) as node:
        services = Services(ear)
        ear.wait('imu/data', 10)
        for interrupt, error in ((lambda: services.ask('cancel'), 'cancelled'),
                                 (lambda: device.send_line('unplug 1'), 'find it')):
            assert interrupted(services, ear, interrupt).endswith(error)
            assert not file.exists()
            ear.wait('imu/data', len(ear.messages['imu/data']) + 20)
        assert device.alive
        assert 'Traceback' not in node.text


def reading(ear):
    """Return whether the node reports diagnostics mode."""
    rates = status(ear, 'Rates')
    return rates and rates.level == DiagnosticStatus.STALE and 'diagnostics mode' in rates.message


def interrupted(services, ear, interrupt):
    """Return the error of an interrupted dump; try again if it ended before."""
    for _ in range(10):
        assert says(ear, 'Rates', DiagnosticStatus.OK, '')
        dump = services.start('nvm/dump')
        assert wait_for(lambda: dump.done() or reading(ear))
        interrupt()
        assert wait_for(dump.done)
        answer = json.loads(dump.result().message)
        if 'error' in answer:
            return answer['error']
        Path(answer['path']).unlink()
    raise AssertionError('ten dumps were over before anything could come between')


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGHUP])
def test_ending_the_node_makes_the_device_leave(emulator, tmp_path, number):
    """At once: this device would not leave by its own time-out before this test gives up."""
    emulator('--nvm-timeout', '3600', *SLOW)
    with listening(HEARD) as ear:
        with driver(str(tmp_path / 'port'), nvm__directory=tmp_path) as node:
            services = Services(ear)
            ear.wait('imu/data', 10)
            services.start('nvm/dump')
            assert wait_for(lambda: reading(ear))
            assert node.end(number) == 0, node.text
            assert 'Traceback' not in node.text
        before = len(ear.messages['imu/data'])
        with driver(str(tmp_path / 'port')):
            ear.wait('imu/data', before + 5)


def test_a_device_that_lets_in_after_power_on_only(emulator, tmp_path):
    """The message has the remedy, switching it off and on, which works."""
    device = emulator('--nvm-window', 'power-on')
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__enter_timeout=1.5):
        services = Services(ear)
        ear.wait('imu/data', 10)
        success, answer = services.ask('read_page')
        assert not success and 'switch the device off and on' in answer['error']

        def switched_off_and_on():
            page = services.start('nvm/read_page')
            device.send_line('power-cycle')
            assert wait_for(page.done)
            return page.result().success

        assert wait_for(switched_off_and_on)
        ear.wait('imu/data', len(ear.messages['imu/data']) + 20)


def test_command_line(emulator, tmp_path):
    """Without ROS, directly on the port; confirmed before a stream is stopped."""
    emulator()
    port, file = ('--port', str(tmp_path / 'port')), tmp_path / 'dump.bin'
    with running('bahrs', 'nvm', 'read', '2', *port) as asked:
        assert asked.wait() == 1 and 'confirm with --yes' in asked.text
    with running('bahrs', 'nvm', 'read', '2', '--yes', *port) as read:
        assert read.wait() == 0 and read.lines[-1].strip() == IMAGE[64:96].hex()
    with running('bahrs', 'nvm', 'dump', str(file), '--yes', *port) as dump:
        assert dump.wait() == 0 and hashlib.sha256(IMAGE).hexdigest() in dump.text
    assert file.read_bytes() == IMAGE
    file.write_bytes(b'precious')
    with running('bahrs', 'nvm', 'dump', str(file), '--yes', *port) as dump:
        assert dump.wait() == 1 and 'exists already: choose another name, or' in dump.text
    assert file.read_bytes() == b'precious'
    with running('bahrs', 'nvm', 'dump', str(file), '--yes', '--force', *port) as dump:
        assert dump.wait() == 0 and file.read_bytes() == IMAGE
    dump = subprocess.run(command('bahrs', 'nvm', 'dump', '-', '--yes', *port),
                          capture_output=True, timeout=PATIENCE, check=True)
    assert dump.stdout == IMAGE and b'8,000 bytes' in dump.stderr


class Silent(StoppableThread):
    """A device on a cable that does not stream, answers slowly, and never leaves by itself."""

    def __init__(self, cable):
        """Create it, not started."""
        super().__init__()
        self._cable = cable
        self._mode = DiagnosticsMode(ServiceBehavior(image=IMAGE, timeout=3600))

    @property
    def active(self):
        """Whether it is in diagnostics mode."""
        return self._mode.active(time.monotonic())

    def run(self):
        """Answer until it is ended."""
        codec = BahrsCodec()
        while not self._ended.wait(0.02):
            for answer in self._mode.receive(self._cable.read(0.02), time.monotonic()):
                self._cable.write(codec.encode(answer, 3))


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_makes_the_device_leave(cable, tmp_path, number):
    """At once, and without a file; further signals change nothing."""
    with Silent(cable) as device, running(
            'bahrs', 'nvm', 'dump', str(tmp_path / 'dump.bin'), '--port', cable.path) as dump:
        assert wait_for(lambda: device.active)
        while dump.alive:
            with contextlib.suppress(ProcessLookupError):
                os.kill(dump.pid, number)
            time.sleep(0.02)
        assert dump.wait() == 130 and 'Traceback' not in dump.text
        assert wait_for(lambda: not device.active)
    assert not list(tmp_path.iterdir())


def test_a_terminal_that_is_closed_makes_the_device_leave(cable, tmp_path):
    """Although nothing can be printed any more."""
    ours, theirs = pty.openpty()
    # The leader of a session that opens a terminal gets it for its own, with its hang-up.
    words = ('sh', '-c', f'exec "$@" <>{os.ttyname(theirs)} >&0 2>&0', 'sh', *command(
        'bahrs', 'nvm', 'dump', str(tmp_path / 'dump.bin'), '--port', cable.path))
    with Silent(cable) as device:
        process = subprocess.Popen(words, start_new_session=True)
        os.close(theirs)
        try:
            assert wait_for(lambda: device.active)
            os.close(ours)
            process.wait(PATIENCE)
        finally:
            process.kill()
            process.wait()
        assert wait_for(lambda: not device.active)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('words, sentence', [
    (['read', '250'], 'page 250 does not exist: pages are 0 to 249'),
    (['read', '0', '--port', '/dev/nowhere'], '/dev/nowhere does not exist'),
    (['dump', '/nowhere/x'], 'cannot write /nowhere/x: No such file or directory: create'),
    (['dump', '.'], 'cannot write .: it is a directory'),
    (['show', '/dev/null'], '/dev/null is not an image: 0 bytes are too few'),
    (['show', 'nowhere.bin'], 'cannot read nowhere.bin'),
])
def test_what_the_command_line_refuses(words, sentence):
    """One sentence, and an exit status that is not 0."""
    status, out, error = run_bahrs('nvm', *words)
    assert status == 1 and out == '' and sentence in error


def test_show(tmp_path):
    """The content of an image; a damaged block is named."""
    from bahrs_driver.emulator.bahrs.nvm_image import example_image
    image = bytearray(example_image())
    file = tmp_path / 'image.bin'
    file.write_bytes(image)
    status, out, error = run_bahrs('nvm', 'show', file)
    assert status == 0 and 'node_id             42' in out and 'BAD' not in out + error
    image[600] ^= 1
    file.write_bytes(image)
    status, out, error = run_bahrs('nvm', 'show', file)
    assert status == 1 and 'CAN (CRC BAD)' in out and 'damaged: CAN' in error

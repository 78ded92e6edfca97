# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The services that read the memory, on the node and the emulator as processes."""

import hashlib
import json
from pathlib import Path
import signal

from bahrs_driver.convert.bahrs import TOPICS
from devices import DIAGNOSTICS, known, says, status
from diagnostic_msgs.msg import DiagnosticStatus
from processes import driver, listening, PATIENCE, running, wait_for
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger

IMAGE = bytes((3 * index + index // 100) % 256 for index in range(8000))
# With this, each page comes so late that a dump takes ten seconds: time to come between.
SLOW = ('--latency-timer', '40')
SERVICES = {'nvm/read_page': Trigger, 'nvm/dump': Trigger, 'nvm/cancel': Trigger,
            'get_parameters': GetParameters, 'set_parameters': SetParameters}
HEARD = {**TOPICS, **DIAGNOSTICS, 'nvm/page': UInt8MultiArray}


class Services:
    """Calls services of the node."""

    def __init__(self, ear):
        """Take the ear to call them from."""
        self._clients = {name: ear.node.create_client(kind, f'/bahrs_driver/{name}')
                         for name, kind in SERVICES.items()}
        for client in self._clients.values():
            assert client.wait_for_service(PATIENCE)
        known(ear)

    def start(self, name, request=None):
        """Call a service and return the future."""
        return self._clients[name].call_async(request or SERVICES[name].Request())

    def call(self, name, request=None):
        """Call a service and return its answer."""
        future = self.start(name, request)
        assert wait_for(future.done)
        return future.result()

    def ask(self, name):
        """Call an nvm service and return whether it succeeded and what it said."""
        answer = self.call(f'nvm/{name}')
        return answer.success, json.loads(answer.message)


@pytest.fixture
def emulator(tmp_path):
    """Give a function that runs the emulator on tmp_path/port with more options."""
    image = tmp_path / 'image.bin'
    image.write_bytes(IMAGE)
    processes = []

    def start(*words):
        command = running('bahrs', 'emulate', '--link', str(tmp_path / 'port'),
                          '--nvm', str(image), *words)
        processes.append(command)
        process = command.__enter__()
        assert wait_for(lambda: process.lines)
        return process

    yield start
    for command in processes:
        command.__exit__(None, None, None)


def test_read_page_and_dump(emulator, tmp_path):
    """Pages, file, SHA-256, topic; what else is asked meanwhile; and the stream is back."""
    emulator(*SLOW)
    file = tmp_path / 'dump.bin'
    with listening(HEARD) as ear, \
            driver(str(tmp_path / 'port'), nvm__page=7, nvm__dump_path=file):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert services.ask('read_page') == (True, {'page': 7, 'data': IMAGE[224:256].hex()})
        assert bytes(ear.wait('nvm/page')[0].data) == IMAGE[224:256]
        value = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=249)
        request = SetParameters.Request(parameters=[Parameter(name='nvm.page', value=value)])
        assert services.call('set_parameters', request).results[0].successful
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
        assert file.read_bytes() == IMAGE
        assert len(ear.wait('nvm/page', 252)) == 252

        ear.wait('imu/data', len(ear.heard['imu/data']) + 20)
        assert says(ear, 'Rates', DiagnosticStatus.OK, 'All messages at their rates')


def test_failures_are_told_and_leave_no_file(emulator, tmp_path):
    """A page that cannot be read, a folder that is not there, nothing to cancel."""
    emulator('--nvm-error-pages', '9')
    file = tmp_path / 'dump.bin'
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__dump_path=file):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert services.ask('dump') == (
            False, {'error': 'the device cannot read page 9 (status 255)'})
        assert not file.exists() and not list(tmp_path.glob('.dump*'))
        assert services.ask('cancel') == (False, {'error': 'no NVM request is under way'})
        ear.wait('imu/data', len(ear.heard['imu/data']) + 20)
    with listening(HEARD) as ear, \
            driver(str(tmp_path / 'port'), nvm__dump_path='/nowhere/dump.bin'):
        services = Services(ear)
        ear.wait('imu/data', 10)
        assert services.ask('dump') == (
            False, {'error': 'cannot write /nowhere/dump.bin: no such folder'})


def test_cancel_and_unplug(emulator, tmp_path):
    """In the midst of a dump; each time the stream comes back by itself."""
    device = emulator(*SLOW)
    file = tmp_path / 'dump.bin'
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__dump_path=file) as node:
        services = Services(ear)
        ear.wait('imu/data', 10)
        for interrupt, error in ((lambda: services.ask('cancel'), 'cancelled'),
                                 (lambda: device.tell('unplug 1'), 'find it')):
            assert interrupted(services, ear, interrupt).endswith(error)
            assert not file.exists()
            ear.wait('imu/data', len(ear.heard['imu/data']) + 20)
        assert device.alive
        assert 'Traceback' not in node.text


def reading(ear):
    """Whether the node says that its device is in diagnostics mode."""
    rates = status(ear, 'Rates')
    return rates and rates.level == DiagnosticStatus.STALE and 'diagnostics mode' in rates.message


def interrupted(services, ear, interrupt):
    """Return the error of a dump that something came between; again if it was too late."""
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


def test_ending_the_node_makes_the_device_leave(emulator, tmp_path):
    """At once: this device would not leave by its own time-out before this test gives up."""
    emulator('--nvm-timeout', '3600', *SLOW)
    with listening(HEARD) as ear:
        with driver(str(tmp_path / 'port')) as node:
            services = Services(ear)
            ear.wait('imu/data', 10)
            services.start('nvm/dump')
            assert wait_for(lambda: reading(ear))
            assert node.end(signal.SIGINT) == 0, node.text
            assert 'Traceback' not in node.text
        before = len(ear.heard['imu/data'])
        with driver(str(tmp_path / 'port')):
            ear.wait('imu/data', before + 5)


def test_a_device_that_lets_in_after_power_on_only(emulator, tmp_path):
    """The message says to switch it off and on; whoever does gets the page."""
    device = emulator('--nvm-window', 'power-on')
    with listening(HEARD) as ear, driver(str(tmp_path / 'port'), nvm__enter_timeout=1.5):
        services = Services(ear)
        ear.wait('imu/data', 10)
        success, answer = services.ask('read_page')
        assert not success and 'switch the device off and on' in answer['error']

        def switched_off_and_on():
            page = services.start('nvm/read_page')
            device.tell('power-cycle')
            assert wait_for(page.done)
            return page.result().success

        assert wait_for(switched_off_and_on)
        ear.wait('imu/data', len(ear.heard['imu/data']) + 20)


def test_command_line(emulator, tmp_path):
    """Without ROS, straight on the port; asked first when a stream would be stopped."""
    emulator()
    port, file = ('--port', str(tmp_path / 'port')), tmp_path / 'dump.bin'
    with running('bahrs', 'nvm', 'read', '2', *port) as asked:
        assert asked.wait() == 1 and 'say --yes' in asked.text
    with running('bahrs', 'nvm', 'read', '2', '--yes', *port) as read:
        assert read.wait() == 0 and read.lines[-1].strip() == IMAGE[64:96].hex()
    with running('bahrs', 'nvm', 'dump', str(file), '--yes', *port) as dump:
        assert dump.wait() == 0 and hashlib.sha256(IMAGE).hexdigest() in dump.text
    assert file.read_bytes() == IMAGE


@pytest.mark.parametrize('words, sentence', [
    (['read', '250'], 'page 250 does not exist: pages are 0 to 249'),
    (['read', '0', '--port', '/dev/nowhere'], '/dev/nowhere does not exist'),
    (['dump', '/nowhere/x'], 'cannot write /nowhere/x: no such folder'),
    (['dump', '.'], 'cannot write .: it is a folder'),
    (['show', '/dev/null'], '/dev/null is no image: 0 bytes are too few'),
    (['show', 'nowhere.bin'], 'cannot read nowhere.bin'),
])
def test_what_the_command_line_refuses(words, sentence):
    """One sentence, and an exit status that is not 0."""
    with running('bahrs', 'nvm', *words) as process:
        assert process.wait() == 1
        assert sentence in process.text and 'Traceback' not in process.text


def test_show(tmp_path):
    """What is in an image; a damaged block is named."""
    from bahrs_driver.emulator.nvm_image import made_up_image
    image = bytearray(made_up_image())
    file = tmp_path / 'image.bin'
    file.write_bytes(image)
    with running('bahrs', 'nvm', 'show', str(file)) as process:
        assert process.wait() == 0
        assert 'node_id             42' in process.text and 'BAD' not in process.text
    image[600] ^= 1
    file.write_bytes(image)
    with running('bahrs', 'nvm', 'show', str(file)) as process:
        assert process.wait() == 1
        assert 'CAN (CRC BAD)' in process.text and 'damaged: CAN' in process.text

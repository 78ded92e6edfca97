# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of diagnostics mode in all variants."""

from dataclasses import dataclass, field
import itertools
import struct
import zlib

from bahrs_driver.emulator.bahrs.diagnostics_mode import INACTIVITY_TIMEOUT, ServiceBehavior
from bahrs_driver.emulator.bahrs.nvm_image import example_image, SIZE
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import (
    Acknowledgement,
    EnterDiagnostics,
    ExitDiagnostics,
    Inertial,
    NvmPage,
    NvmReadRequest,
)
import pytest
from support.emulated import decoded, emissions, make_device

VARIANTS = list(itertools.product(('crc32', 'byte'), (False, True)))
ENTERED, LEFT = Acknowledgement(0xF0, 0), Acknowledgement(0xF1, 0)


@dataclass
class Host:
    """A host that sends requests and collects the stream."""

    device: object
    checksum: str = 'crc32'
    padded: bool = False
    codec: BahrsCodec = field(default_factory=BahrsCodec)

    def ask(self, message, time, version=3):
        """Send a request at a time; return the answers, decoded."""
        padded = self.padded and not isinstance(message, NvmReadRequest)
        emissions(self.device, time)
        request = self.codec.encode(message, version, self.checksum, padded)
        return decoded(b''.join(
            emission.data for byte in request
            for emission in self.device.receive(bytes([byte]), time)))

    def stream(self, until):
        """Return the messages of the stream."""
        return decoded(b''.join(emission.data for emission in emissions(self.device, until)))


def host(checksum='crc32', padded=False, **behavior):
    """Return a host at a device of its own variant."""
    service = ServiceBehavior(checksum, padded, **behavior)
    return Host(make_device(service=service), checksum, padded)


@pytest.mark.parametrize(('checksum', 'padded'), VARIANTS)
def test_a_whole_dump_equals_the_image(checksum, padded):
    """Enter, 250 pages, exit: the stream pauses, and resumes afterwards."""
    image = bytes(index * 7 % 251 for index in range(SIZE))
    asked = host(checksum, padded, image=image)
    assert asked.stream(1.0)
    assert asked.ask(EnterDiagnostics(), 1.0) == [ENTERED]
    pages = []
    for page in range(250):
        pages += asked.ask(NvmReadRequest(page), 1.0 + 0.01 * page)
        assert asked.stream(1.005 + 0.01 * page) == []
    assert [page.page for page in pages] == list(range(250))
    assert b''.join(page.data for page in pages) == image
    assert asked.ask(ExitDiagnostics(), 4.0) == [LEFT]
    assert any(isinstance(message, Inertial) for message in asked.stream(4.02))


@pytest.mark.parametrize(('checksum', 'padded'), VARIANTS)
def test_other_variants_are_ignored(checksum, padded):
    """Neither another checksum nor another padding is accepted."""
    asked = host(checksum, padded)
    for other in VARIANTS:
        asked.checksum, asked.padded = other
        answers = asked.ask(EnterDiagnostics(), 1.0)
        assert bool(answers) == (other == (checksum, padded))


def test_answers_come_in_the_variant_of_the_device():
    """Answers are unpadded and have the checksum of the device."""
    for checksum in ('crc32', 'byte'):
        asked = host(checksum)
        request = asked.codec.encode(EnterDiagnostics(), 3, checksum)
        answer, = asked.device.receive(request, 1.0)
        assert answer.data == asked.codec.encode(ENTERED, 3, checksum, padded=False)
        assert answer.ready > 1.0


def test_five_seconds_without_a_request_end_it():
    """Each request restarts the time-out."""
    asked = host()
    asked.ask(EnterDiagnostics(), 1.0)
    assert asked.stream(5.9) == []
    assert isinstance(asked.ask(NvmReadRequest(3), 5.9)[0], NvmPage)
    assert asked.stream(5.9 + INACTIVITY_TIMEOUT - 0.01) == []
    assert asked.stream(5.9 + INACTIVITY_TIMEOUT + 0.02)
    assert asked.ask(NvmReadRequest(3), 11.0) == []


@pytest.mark.parametrize(('time', 'let_in'), [(0.05, True), (0.5, True), (0.55, False),
                                              (20.0, False)])
def test_known_firmware_enters_after_power_on_only(time, let_in):
    """The window lasts half a second; a power cycle opens it again."""
    asked = host(window='power-on')
    assert bool(asked.ask(EnterDiagnostics(), time)) == let_in
    asked.device.power_cycle(time + 1.0)
    assert asked.ask(EnterDiagnostics(), time + 1.3) == [ENTERED]


def test_pages_that_cannot_be_read_are_refused():
    """Chosen pages and pages that do not exist fail; the others are read."""
    asked = host(error_pages=frozenset({3, 17}))
    asked.ask(EnterDiagnostics(), 1.0)
    for page in (3, 17, 250, 255):
        assert asked.ask(NvmReadRequest(page), 1.1) == [Acknowledgement(0xF2, 0xFF)]
    assert asked.ask(NvmReadRequest(4), 1.1) == [NvmPage(4, example_image()[128:160])]


def test_outside_the_mode_only_entering_is_accepted():
    """Requests to read and to leave are ignored."""
    asked = host()
    assert asked.ask(NvmReadRequest(0), 1.0) == []
    assert asked.ask(ExitDiagnostics(), 1.0) == []
    assert asked.stream(1.5)


def test_entering_twice_is_acknowledged_twice():
    """The second request is acknowledged after the window has closed, too."""
    asked = host(window='power-on')
    assert asked.ask(EnterDiagnostics(), 0.3) == [ENTERED]
    assert asked.ask(EnterDiagnostics(), 1.3) == [ENTERED]


def test_a_power_cycle_ends_it():
    """The device streams again and ignores earlier requests."""
    asked = host()
    asked.ask(EnterDiagnostics(), 1.0)
    asked.device.power_cycle(1.5)
    assert asked.stream(2.2)


def test_counters_go_on_after_it_and_so_does_the_clock():
    """Counters continue without a gap, and device time includes the pause."""
    asked = host()
    before = [message for message in asked.stream(1.0) if isinstance(message, Inertial)]
    asked.ask(EnterDiagnostics(), 1.0)
    asked.ask(ExitDiagnostics(), 3.0)
    emission = next(item for item in emissions(asked.device, 4.0) if item.name == 'inertial')
    assert emission.truth['sequence'] == before[-1].sequence + 1
    assert emission.truth['device_time_us'] == pytest.approx(3_000_000, abs=5_000)


def test_noise_on_the_line_is_no_request():
    """Random bytes cause no answer and no error."""
    device = make_device()
    assert device.receive(bytes(range(256)) * 40 + b'NE\x03\x00\xf0', 1.0) == []


def test_the_invented_image_has_the_real_format():
    """The image has version 1.1, and every checksum is right."""
    image = example_image()
    assert len(image) == SIZE == 8000
    assert struct.unpack_from('<2I', image) == (1, 1)
    for start, length in ((0, 8), (12, 12), (28, 48), (596, 60)):
        checksum, = struct.unpack_from('<I', image, start + length)
        assert checksum == zlib.crc32(image[start:start + length])

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the diagnostics session, against a device in simulated time."""

from itertools import cycle

from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceBehavior
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    Acknowledgement,
    EnterDiagnostics,
    ExitDiagnostics,
    Inertial,
    NvmPage,
    NvmReadRequest,
)
from bahrs_driver.protocol.bahrs.nvm_session import (
    ANSWER_TIMEOUT,
    LEAVE_ATTEMPTS,
    LOSS_TIME,
    NvmSession,
    PAGE_TIME,
    READ_TIME,
    SessionState,
)
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.units import NS_PER_S
from bahrs_driver.virtual_serial.faults import Faults
from hypothesis import given, strategies
import pytest

IMAGE = bytes((7 * index + index // 251) % 256 for index in range(8000))
STREAM = Inertial(0, (0.0,) * 3, (0.0,) * 3, (Integrity.SAFE,) * 6)
STEP = 0.001
ANSWER = 0.004              # s from a request to its answer


def ns(seconds):
    """Return seconds in nanoseconds."""
    return round(seconds * NS_PER_S)


class Bench:
    """A device, a line with faults, and a host with a session, moved on in small steps."""

    def __init__(self, pages=range(250), error_rate=0.0, **behavior):
        """Set up a device that is on since a second; error_rate is per byte."""
        self.codec = BahrsCodec()
        self.device = DiagnosticsMode(ServiceBehavior(image=IMAGE, **behavior))
        self.now = 1.0
        self.session = NvmSession(pages, ns(self.now))
        self.framer = Framer(BahrsFormat())
        self.faults = Faults(5, {'bit_flip': error_rate})
        self.sent = []              # requests, by type
        self.silent = False
        self._due = []              # answers under way
        self._stream_due = self.now

    def step(self):
        """Let a millisecond pass."""
        self.now += STEP
        data = self.session.send(ns(self.now))
        if data:
            self.sent += [frame.data[4] for frame in Framer(BahrsFormat()).feed(data)]
            if not self.silent:
                for message in self.device.receive(self.faults.apply(data), self.now):
                    self._due.append((self.now + ANSWER, message))
        for message in self._arriving():
            checksum = None if isinstance(message, Inertial) else self.device._behavior.checksum
            frame = self.faults.apply(self.codec.encode(message, 3, checksum))
            for found in self.framer.feed(frame):
                self.session.receive(self.codec.decode(found), found.checksum, ns(self.now))

    def _arriving(self):
        if self.silent:
            return
        ready = [message for due, message in self._due if due <= self.now]
        self._due = [item for item in self._due if item[0] > self.now]
        yield from ready
        if self.now >= self._stream_due and not self.device.active(self.now):
            self._stream_due = self.now + 0.005
            yield STREAM

    def run(self, seconds=60.0, until=lambda bench: False):
        """Go on until the session is finished, or something else is so."""
        end = self.now + seconds
        while self.session.state is not SessionState.FINISHED and not until(self):
            assert self.now < end, f'still {self.session.state} after {seconds} s'
            self.step()
        return self.session

    @property
    def dump(self):
        """All pages that were read, one behind the other."""
        return b''.join(self.session.pages[page] for page in sorted(self.session.pages))


@pytest.mark.parametrize('window', ['always', 'power-on'])
@pytest.mark.parametrize('padded', [False, True])
@pytest.mark.parametrize('checksum', ['crc32', 'byte'])
def test_a_dump_in_every_variant(checksum, padded, window):
    """Equal to the image; afterwards the device streams."""
    bench = Bench(checksum=checksum, padded=padded, window=window)
    if window == 'power-on':
        bench.run(3, until=lambda bench: bench.now > 3)
        assert bench.session.state is SessionState.ENTERING
        bench.device.restart(bench.now)
    session = bench.run()
    assert not session.error and bench.dump == IMAGE
    assert not bench.device.active(bench.now)
    assert bench.sent.count(NvmReadRequest.TYPE) == 250


class Restless(DiagnosticsMode):
    """A device that agrees to diagnostics mode, and goes on streaming."""

    def active(self, time):
        """Never stay in it."""
        return False


def test_a_device_that_agrees_and_goes_on_streaming():
    """It is asked again a few times, and then left alone."""
    bench = Bench()
    bench.device = Restless(ServiceBehavior(image=IMAGE))
    session = bench.run(10)
    assert 'entered diagnostics mode 5 times and did not stay in it' in session.error
    assert bench.sent.count(EnterDiagnostics.TYPE) < 20


ANSWERS = strategies.sampled_from([
    STREAM, *(Acknowledgement(kind.TYPE, status) for status in (0, 255)
              for kind in (EnterDiagnostics, ExitDiagnostics, NvmReadRequest)),
    NvmPage(0, bytes(32)), NvmPage(1, bytes(32)), NvmPage(249, bytes(32))])


@given(strategies.lists(strategies.tuples(
    ANSWERS, strategies.integers(1, 100), strategies.floats(0.0, 2.0)), min_size=1),
    strategies.sampled_from([[0], [1, 2], range(250)]), strategies.floats(0.0, 60.0))
def test_every_session_ends_in_time(answers, pages, enter_timeout):
    """Whatever the device sends, as often as it likes, and whenever."""
    session, now = NvmSession(pages, 0, ns(enter_timeout)), 0
    for message, count, pause in cycle(answers):
        until = now + ns(max(pause, 0.01))
        while not session.finished and session.due(now) < until:
            now = max(now, session.due(now))
            session.send(now)
        if session.finished:
            break
        now = until
        for _ in range(count):
            session.receive(message, 'crc32', now)
    limit = ns(enter_timeout) + READ_TIME + PAGE_TIME * len(pages) \
        + LEAVE_ATTEMPTS * ANSWER_TIMEOUT
    assert now <= limit + ns(0.01)
    assert session.error or len(session.pages) == len(pages)
    assert session.due(now) is None and session.send(10 * limit) == b''


def test_one_page():
    """And no other is asked for."""
    bench = Bench([17])
    assert bench.run().pages == {17: IMAGE[17 * 32:18 * 32]}
    assert bench.sent.count(NvmReadRequest.TYPE) == 1


@pytest.mark.parametrize('checksum', ['crc32', 'byte'])
def test_a_dump_over_a_line_that_damages_every_hundredth_byte(checksum):
    """Answers and requests are repeated until all is there."""
    bench = Bench(error_rate=0.01, checksum=checksum)
    session = bench.run(300)
    assert not session.error and bench.dump == IMAGE
    assert bench.sent.count(NvmReadRequest.TYPE) > 300


def test_a_page_that_cannot_be_read_is_named():
    """The session fails, and the device is told to leave."""
    bench = Bench(error_pages=frozenset({3}))
    session = bench.run()
    assert session.error == 'the device cannot read page 3 (status 255)'
    assert sorted(session.pages) == [0, 1, 2]
    assert not bench.device.active(bench.now)


def test_power_cycle_in_the_middle():
    """The device streams again; it is asked to enter again, and nothing is read twice."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 100)
    bench.device.restart(bench.now)
    session = bench.run()
    assert not session.error and bench.dump == IMAGE
    assert bench.sent.count(NvmReadRequest.TYPE) < 260


def test_power_cycle_of_a_device_that_lets_in_late():
    """The user is told to switch it off and on, and whoever does so gets the rest."""
    bench = Bench(window='power-on')
    bench.device.restart(bench.now)
    bench.run(until=lambda bench: len(bench.session.pages) == 100)
    bench.device.restart(bench.now - 0.6)
    bench.run(until=lambda bench: bench.session.state is SessionState.ENTERING)
    bench.device.restart(bench.now + 2)
    session = bench.run()
    assert not session.error and bench.dump == IMAGE


def test_a_device_that_never_lets_in():
    """After the time-out the message says what to do, and the stream is left alone."""
    bench = Bench(window='power-on')
    session = bench.run(40)
    assert 'within 30 s' in session.error and 'switch the device off and on' in session.error
    assert not session.pages


def test_a_device_that_is_silent():
    """Nothing answers, not even to leaving."""
    bench = Bench()
    bench.silent = True
    session = bench.run(40)
    assert 'did not enter diagnostics mode' in session.error


def test_a_device_that_falls_silent():
    """The page that never came is named; the device will leave by itself."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 5)
    bench.silent = True
    assert bench.run(10).error == 'page 5 was requested 40 times and never arrived'


def test_cancelled():
    """The device is told to leave."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 5)
    bench.session.cancel('cancelled', ns(bench.now))
    session = bench.run()
    assert session.error == 'cancelled' and not bench.device.active(bench.now)
    assert ExitDiagnostics.TYPE in bench.sent


def test_cancelled_while_entering():
    """The device may just have agreed: it is told to leave all the same."""
    bench = Bench()
    bench.step()
    bench.step()
    assert bench.session.state is SessionState.ENTERING and bench.device.active(bench.now)
    bench.session.cancel('cancelled', ns(bench.now))
    assert bench.run().error == 'cancelled' and not bench.device.active(bench.now)


def session_that_reads(*pages):
    """Return a session that has entered and asked for its first page at the time 0."""
    session = NvmSession(pages, 0)
    session.send(0)
    session.receive(Acknowledgement(EnterDiagnostics.TYPE, 0), 'crc32', 0)
    session.send(0)
    return session


def page(number):
    """Return a page whose bytes are its number."""
    return NvmPage(number, bytes([number]) * 32)


def test_the_wrong_page_is_no_answer():
    """Nor is a page that is there already: both are answers to older requests."""
    session = session_that_reads(4, 5)
    session.receive(page(5), 'crc32', ns(0.01))
    assert not session.pages
    session.receive(page(4), 'crc32', ns(0.02))
    session.receive(page(4), 'crc32', ns(0.03))
    assert list(session.pages) == [4] and session.state is SessionState.READING
    session.receive(page(5), 'crc32', ns(0.04))
    assert session.pages == {4: b'\4' * 32, 5: b'\5' * 32}
    assert session.state is SessionState.LEAVING


def test_a_refusal_is_asked_about_again_before_it_is_believed():
    """It may be the answer to a request that was made twice."""
    session = session_that_reads(4, 5)
    for _ in range(2):
        session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.01))
    session.receive(page(4), 'crc32', ns(0.02))
    for _ in range(2):
        session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.03))
    assert session.state is SessionState.READING
    session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.03))
    assert session.error == 'the device cannot read page 5 (status 255)'


def test_stream_that_is_still_under_way_is_no_restart():
    """A few messages that were sent before the device agreed."""
    session = session_that_reads(4)
    for _ in range(10):
        session.receive(STREAM, 'word', ns(0.01))
    assert session.state is SessionState.READING


def test_refused_entry():
    """A status other than 0."""
    session = NvmSession([0], 0)
    session.send(0)
    session.receive(Acknowledgement(EnterDiagnostics.TYPE, 7), 'crc32', 0)
    assert session.error == 'the device refuses diagnostics mode (status 7)'


def test_requests_carry_the_version_of_the_device_and_the_variant_asked_for():
    """As the user forces it."""
    session = NvmSession([0], 0, version=2, service_frames='mpeg2')
    assert session.send(0) == BahrsCodec().encode(EnterDiagnostics(), 2, 'byte', False)
    assert session.send(ns(0.01)) == b'' and session.due(ns(0.01)) == ns(0.05)
    assert session.send(ns(0.06)) == BahrsCodec().encode(EnterDiagnostics(), 2, 'byte', False)


def test_automatic_entering_tries_the_makers_variant_first():
    """Then that of the document."""
    session = NvmSession([0], 0)
    assert session.send(0).hex() == '4e450300f07ff5d032'
    assert session.send(ns(0.1)).hex() == '4e450300f0000000b7e85e7b'


@pytest.mark.parametrize('pages', [[], [250], [-1], [0, 300]])
def test_pages_that_do_not_exist(pages):
    """A caller's mistake."""
    with pytest.raises(ValueError, match='NVM pages are 0 to 249'):
        NvmSession(pages, 0)


def test_progress():
    """From nothing to all."""
    session = session_that_reads(4, 5)
    assert session.progress == 0
    session.receive(page(4), 'crc32', ns(0.02))
    assert session.progress == 0.5


def test_abandoned():
    """With nobody left to talk to, it is over at once."""
    session = session_that_reads(4)
    session.abandon('the port is gone')
    assert session.state is SessionState.FINISHED and session.error == 'the port is gone'
    assert session.send(1.0) == b''


def test_a_failed_write_ends_the_session_when_no_better_reason_is_reported():
    """The reader of a lost link has some time to report one. Answers do not extend it."""
    session = session_that_reads(4, 5)
    session.record_write('the port is gone', 0)
    session.receive(page(4), 'crc32', ns(0.01))
    assert session.due(ns(0.02)) == LOSS_TIME and session.send(LOSS_TIME - 1) == b''
    assert not session.finished
    assert session.send(LOSS_TIME) == b'' and session.error == 'the port is gone'
    session = session_that_reads(4)
    session.record_write('the port is gone', 0)
    session.abandon('the port is gone: plug it in again')
    assert session.finished and session.error == 'the port is gone: plug it in again'
    assert session.send(LOSS_TIME) == b'' and session.error.endswith('plug it in again')


def test_a_finished_session_has_no_error_of_a_link_lost_later():
    """All its pages were read."""
    session = session_that_reads(4)
    session.receive(page(4), 'crc32', ns(0.01))
    session.receive(Acknowledgement(ExitDiagnostics.TYPE, 0), 'crc32', ns(0.02))
    session.abandon('the port is gone')
    assert session.finished and not session.error

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
from hypothesis import example, given, strategies
import pytest

IMAGE = bytes((7 * index + index // 251) % 256 for index in range(8000))
STREAM = Inertial(0, (0.0,) * 3, (0.0,) * 3, (Integrity.SAFE,) * 6)
STEP = 0.001
ANSWER = 0.004              # s from a request to its answer


def ns(seconds):
    """Return seconds in nanoseconds."""
    return round(seconds * NS_PER_S)


class Bench:
    """A device, a line with faults, and a session, simulated in small steps."""

    def __init__(self, pages=range(250), error_rate=0.0, **behavior):
        """Create a device that was switched on a second ago; error_rate is per byte."""
        self.codec = BahrsCodec()
        self.device = DiagnosticsMode(ServiceBehavior(image=IMAGE, **behavior))
        self.now = 1.0
        self.session = NvmSession(pages, ns(self.now))
        self.framer = Framer(BahrsFormat())
        self.faults = Faults(5, {'bit_flip': error_rate})
        self.sent = []              # requests, by type
        self.silent = False
        self._due = []              # answers on the line
        self._stream_due = self.now

    def step(self):
        """Simulate a millisecond."""
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
        """Simulate until the session is finished, or a condition holds."""
        end = self.now + seconds
        while self.session.state is not SessionState.FINISHED and not until(self):
            assert self.now < end, f'still {self.session.state} after {seconds} s'
            self.step()
        return self.session

    @property
    def dump(self):
        """Return all pages that were read, concatenated."""
        return b''.join(self.session.pages[page] for page in sorted(self.session.pages))


@pytest.mark.parametrize('window', ['always', 'power-on'])
@pytest.mark.parametrize('padded', [False, True])
@pytest.mark.parametrize('checksum', ['crc32', 'byte'])
def test_a_dump_succeeds_in_every_variant(checksum, padded, window):
    """It equals the image; afterwards the device streams."""
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
    """A device that acknowledges diagnostics mode, and continues to stream."""

    def active(self, time):
        """Return False: it does not stay in the mode."""
        return False


def test_a_device_that_acknowledges_and_continues_to_stream_is_given_up():
    """It is requested to enter a few times."""
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
@example([*[(STREAM, 1, 0.0)] * 3, (Acknowledgement(EnterDiagnostics.TYPE, 0), 1, 0.0),
          (STREAM, 1, 0.0), (STREAM, 2, 0.0), (STREAM, 11, 2.0)], [0], 4.0)
def test_every_session_ends_in_time(answers, pages, enter_timeout):
    """Whatever the device sends, as often as it likes, and whenever."""
    session, now = NvmSession(pages, 0, ns(enter_timeout)), 0
    limit = ns(enter_timeout) + READ_TIME + PAGE_TIME * len(pages) \
        + LEAVE_ATTEMPTS * ANSWER_TIMEOUT
    for message, count, pause in cycle(answers):
        until = now + ns(max(pause, 0.01))
        while not session.finished and session.due(now) < until:
            assert session.due(now) <= limit
            now = max(now, session.due(now))
            session.send(now)
        if session.finished:
            break
        now = until
        for _ in range(count):
            session.receive(message, 'crc32', now)
    assert now <= limit + ns(0.01)
    assert session.error or len(session.pages) == len(pages)
    assert session.due(now) is None and session.send(10 * limit) == b''


def test_one_page_is_read():
    """No other page is requested."""
    bench = Bench([17])
    assert bench.run().pages == {17: IMAGE[17 * 32:18 * 32]}
    assert bench.sent.count(NvmReadRequest.TYPE) == 1


@pytest.mark.parametrize('checksum', ['crc32', 'byte'])
def test_a_dump_over_a_line_that_damages_every_hundredth_byte(checksum):
    """Requests are repeated until all pages are complete."""
    bench = Bench(error_rate=0.01, checksum=checksum)
    session = bench.run(300)
    assert not session.error and bench.dump == IMAGE
    assert bench.sent.count(NvmReadRequest.TYPE) > 300


def test_the_error_names_a_page_that_cannot_be_read():
    """The session fails, and requests the device to leave."""
    bench = Bench(error_pages=frozenset({3}))
    session = bench.run()
    assert session.error == 'the device cannot read page 3 (status 255)'
    assert sorted(session.pages) == [0, 1, 2]
    assert not bench.device.active(bench.now)


def test_a_power_cycle_while_reading_does_not_end_the_session():
    """The device is requested to enter again, and no page is read twice."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 100)
    bench.device.restart(bench.now)
    session = bench.run()
    assert not session.error and bench.dump == IMAGE
    assert bench.sent.count(NvmReadRequest.TYPE) < 260


def test_a_device_that_accepts_after_power_on_only_can_be_power_cycled():
    """The remaining pages are read if the user switches it off and on."""
    bench = Bench(window='power-on')
    bench.device.restart(bench.now)
    bench.run(until=lambda bench: len(bench.session.pages) == 100)
    bench.device.restart(bench.now - 0.6)
    bench.run(until=lambda bench: bench.session.state is SessionState.ENTERING)
    bench.device.restart(bench.now + 2)
    session = bench.run()
    assert not session.error and bench.dump == IMAGE


def test_a_device_that_never_accepts_ends_the_session():
    """The error has a remedy, and the stream continues."""
    bench = Bench(window='power-on')
    session = bench.run(40)
    assert 'within 30 s' in session.error and 'switch the device off and on' in session.error
    assert not session.pages


def test_a_silent_device_ends_the_session():
    """It does not answer the request to leave either."""
    bench = Bench()
    bench.silent = True
    session = bench.run(40)
    assert 'did not enter diagnostics mode' in session.error


def test_the_error_names_the_page_at_which_a_device_falls_silent():
    """The device leaves the mode by itself later."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 5)
    bench.silent = True
    assert bench.run(10).error == 'page 5 was requested 40 times and never arrived'


def test_a_cancelled_session_leaves():
    """The device is requested to leave."""
    bench = Bench()
    bench.run(until=lambda bench: len(bench.session.pages) == 5)
    bench.session.cancel('cancelled', ns(bench.now))
    session = bench.run()
    assert session.error == 'cancelled' and not bench.device.active(bench.now)
    assert ExitDiagnostics.TYPE in bench.sent


def test_a_session_cancelled_while_entering_leaves():
    """The device may just have entered."""
    bench = Bench()
    bench.step()
    bench.step()
    assert bench.session.state is SessionState.ENTERING and bench.device.active(bench.now)
    bench.session.cancel('cancelled', ns(bench.now))
    assert bench.run().error == 'cancelled' and not bench.device.active(bench.now)


def session_that_reads(*pages):
    """Return a session that has entered and requested its first page at the time 0."""
    session = NvmSession(pages, 0)
    session.send(0)
    session.receive(Acknowledgement(EnterDiagnostics.TYPE, 0), 'crc32', 0)
    session.send(0)
    return session


def page(number):
    """Return a page filled with its number."""
    return NvmPage(number, bytes([number]) * 32)


def test_another_page_is_ignored():
    """So is a page that was read before: both are answers to older requests."""
    session = session_that_reads(4, 5)
    session.receive(page(5), 'crc32', ns(0.01))
    assert not session.pages
    session.receive(page(4), 'crc32', ns(0.02))
    session.receive(page(4), 'crc32', ns(0.03))
    assert list(session.pages) == [4] and session.state is SessionState.READING
    session.receive(page(5), 'crc32', ns(0.04))
    assert session.pages == {4: b'\4' * 32, 5: b'\5' * 32}
    assert session.state is SessionState.LEAVING


def test_a_refused_page_is_requested_again_before_the_session_fails():
    """The refusal may answer a repeated request."""
    session = session_that_reads(4, 5)
    for _ in range(2):
        session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.01))
    session.receive(page(4), 'crc32', ns(0.02))
    for _ in range(2):
        session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.03))
    assert session.state is SessionState.READING
    session.receive(Acknowledgement(NvmReadRequest.TYPE, 255), 'crc32', ns(0.03))
    assert session.error == 'the device cannot read page 5 (status 255)'


def test_stream_messages_on_the_line_are_no_restart():
    """The device sent them before it entered the mode."""
    session = session_that_reads(4)
    for _ in range(10):
        session.receive(STREAM, 'word', ns(0.01))
    assert session.state is SessionState.READING


def test_a_refused_entry_ends_the_session():
    """Its status is not 0."""
    session = NvmSession([0], 0)
    session.send(0)
    session.receive(Acknowledgement(EnterDiagnostics.TYPE, 7), 'crc32', 0)
    assert session.error == 'the device refuses diagnostics mode (status 7)'


def test_requests_have_the_version_of_the_device_and_the_forced_variant():
    """They are repeated in the same variant."""
    session = NvmSession([0], 0, version=2, service_frames='mpeg2')
    assert session.send(0) == BahrsCodec().encode(EnterDiagnostics(), 2, 'byte', False)
    assert session.send(ns(0.01)) == b'' and session.due(ns(0.01)) == ns(0.05)
    assert session.send(ns(0.06)) == BahrsCodec().encode(EnterDiagnostics(), 2, 'byte', False)


def test_the_variant_of_the_maker_is_tried_first():
    """The next one is that of the document."""
    session = NvmSession([0], 0)
    assert session.send(0).hex() == '4e450300f07ff5d032'
    assert session.send(ns(0.1)).hex() == '4e450300f0000000b7e85e7b'


@pytest.mark.parametrize('pages', [[], [250], [-1], [0, 300]])
def test_pages_out_of_range_are_refused(pages):
    """They are a mistake of the caller."""
    with pytest.raises(ValueError, match='NVM pages are 0 to 249'):
        NvmSession(pages, 0)


def test_progress_is_the_share_of_pages():
    """From 0 to 1."""
    session = session_that_reads(4, 5)
    assert session.progress == 0
    session.receive(page(4), 'crc32', ns(0.02))
    assert session.progress == 0.5


def test_an_abandoned_session_ends_at_once():
    """The device cannot be reached any more."""
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

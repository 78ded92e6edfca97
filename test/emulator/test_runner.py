# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""An emulation in real time, in this process; and the lines that command it."""

import contextlib
import io
import os
import threading
import time

from bahrs_driver.emulator.runner import ControlInput, PacedRun, run_to_file
from bahrs_driver.emulator.scenario import parse
from bahrs_driver.emulator.session import Session
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import Acknowledgement, EnterDiagnostics, Inertial
import pytest
from support.emulated import decoded, make_device, make_emulation


@contextlib.contextmanager
def control():
    """Give a control input and what writes into it."""
    out, into = os.pipe()
    try:
        yield ControlInput(out), lambda text: os.write(into, text)
    finally:
        os.close(out)
        os.close(into)


@contextlib.contextmanager
def opened(path):
    """Open a port, as a driver does."""
    port = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        yield port
    finally:
        os.close(port)


def heard(port):
    """Return all that waits at a port: one read may bring less."""
    data = b''
    with contextlib.suppress(BlockingIOError):
        while True:
            data += os.read(port, 65536)
    return data


class Run:
    """A paced run with nobody at its control, that notes what it is told."""

    def __init__(self, link=None, commands=None):
        """Take where commands come from."""
        self.names, self.complaints = [], []
        self.paced = PacedRun(link, commands or ControlInput(None), self.names.append,
                              self.complaints.append)

    def started(self):
        """Let time begin; return the port."""
        self.paced.start()
        return self.names[-1]

    def __enter__(self):
        """Return the run itself."""
        return self

    def __exit__(self, *_):
        """Take the port away."""
        self.paced.close()


def session(*scenario, **behavior):
    """Return a session with a scenario."""
    return Session(make_emulation(make_device(**behavior)), parse(scenario))


def test_it_keeps_time_and_ends_in_time():
    """What is sent in a second takes a second."""
    with Run() as run, opened(run.started()) as port:
        began = time.monotonic()
        run.paced.run(session(), 1.0)
        assert time.monotonic() - began >= 1.0
        inertial = [message for message in decoded(heard(port))
                    if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(80, abs=2)
    assert run.paced.lost == 0


def test_it_is_never_too_late_for_what_is_due():
    """Though the process slept over all of it."""
    with Run() as run, opened(run.started()) as port:
        time.sleep(0.8)
        talk = session('0.1 integrity nose risk', '0.6 quit')
        run.paced.run(talk, 0.7)
        inertial = [message for message in decoded(heard(port)) if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(20, abs=2)
    assert len(run.complaints) == 1 and talk.emulation.ended


def test_zero_is_now_by_all_clocks():
    """And time begins at the start, not before."""
    with Run() as run:
        zero = run.paced.start()
    assert abs(zero.monotonic_ns - time.monotonic_ns()) < 60e9
    assert abs(zero.unix_ns - time.time_ns()) < 60e9


def test_it_can_be_told_to_end():
    """While it waits for somebody, and while it runs."""
    with Run() as run:
        threading.Timer(0.1, run.paced.end).start()
        run.paced.start(wait=True)
        run.paced.run(session())
    with Run() as run:
        threading.Timer(0.2, run.paced.end).start()
        run.paced.start()
        run.paced.run(session())


def test_what_the_host_asks_is_answered():
    """In the order of requests."""
    with Run() as run, opened(run.started()) as port:
        os.write(port, BahrsCodec().encode(EnterDiagnostics(), 3))
        talk, data, until = session(), b'', 0.0
        while Acknowledgement(0xF0, 0) not in decoded(data) and until < 60.0:
            until += 0.3
            run.paced.run(talk, until)
            data += heard(port)
    assert Acknowledgement(0xF0, 0) in decoded(data)


def test_the_plug_is_pulled_and_put_back(tmp_path):
    """The link goes and comes; whoever opens it then finds the device at work."""
    link = tmp_path / 'port'
    with Run(str(link)) as run:
        run.paced.start()
        talk = session('0.05 unplug 0.2')
        run.paced.run(talk, 0.15)
        assert not link.is_symlink()
        run.paced.run(talk, 0.4)
        assert link.is_symlink() and run.names == [str(link)] * 2
        with opened(link) as port:
            run.paced.run(talk, 1.0)
            assert decoded(heard(port))
    assert not link.is_symlink()


def test_a_reader_that_sleeps_loses_bytes_and_stops_nobody():
    """They are counted."""
    with Run() as run, opened(run.started()):
        talk = session()
        talk.emulation.cable.send(0.0, bytes(1_000_000))
        talk.emulation.cable.byte_time = 1e-9
        run.paced.run(talk, 0.2)
        assert run.paced.lost > 500_000


def test_commands_come_in_lines_and_wrong_ones_end_nothing():
    """Nor does a scenario that asks for what there is not."""
    with control() as (commands, say), Run(commands=commands) as run:
        run.paced.start()
        say(b'nonsense\nfault rust=1\n')
        talk = session('0.05 integrity nose risk', '0.1 quit')
        run.paced.run(talk, 10.0)
    assert talk.emulation.ended
    assert len(run.complaints) == 3
    assert all(any(word in complaint for complaint in run.complaints)
               for word in ('nonsense', 'rust', 'nose'))


def test_lines_may_come_in_pieces():
    """And the last without an end."""
    with control() as (commands, say):
        say(b'first\nsec')
        assert commands.lines() == ['first']
        say(b'ond\nthird\n')
        assert commands.lines() == ['second', 'third']
    out, into = os.pipe()
    os.write(into, b'last')
    os.close(into)
    commands = ControlInput(out)
    assert commands.lines() == []
    assert commands.lines() == ['last'] and commands.descriptor is None
    assert commands.lines() == []
    os.close(out)


def test_a_file_gets_all_that_was_sent():
    """Whatever the adapter would have held back."""
    results = set()
    for mode in ('none', 'packets', 0.016):
        file = io.BytesIO()
        run_to_file(Session(make_emulation(mode=mode)), 2.5, file)
        results.add(file.getvalue())
    assert len(results) == 1
    assert len(decoded(results.pop())) > 1.8 * 330

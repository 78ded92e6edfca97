# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of an emulation in real time, in this process, and of its control input."""

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
    """Return a control input and its writing end."""
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
    """Return all unread bytes of a port: one read may return fewer."""
    data = b''
    with contextlib.suppress(BlockingIOError):
        while True:
            data += os.read(port, 65536)
    return data


class Run:
    """A paced run without commands that records names and complaints."""

    def __init__(self, link=None, commands=None):
        """Set the source of commands."""
        self.names, self.complaints = [], []
        self.paced = PacedRun(link, commands or ControlInput(None), self.names.append,
                              self.complaints.append)

    def started(self):
        """Start; return the port."""
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
    """The bytes of a second take a second."""
    with Run() as run, opened(run.started()) as port:
        began = time.monotonic()
        run.paced.run(session(), 1.0)
        assert time.monotonic() - began >= 1.0
        inertial = [message for message in decoded(heard(port))
                    if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(80, abs=2)
    assert run.paced.lost == 0


def test_a_late_process_catches_up():
    """Everything happens, even if the process slept meanwhile."""
    with Run() as run, opened(run.started()) as port:
        time.sleep(0.8)
        talk = session('0.1 integrity nose risk', '0.6 quit')
        run.paced.run(talk, 0.7)
        inertial = [message for message in decoded(heard(port)) if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(20, abs=2)
    assert len(run.complaints) == 1 and talk.emulation.ended


def test_time_zero_on_all_clocks():
    """Time starts at start()."""
    with Run() as run:
        zero = run.paced.start()
    assert abs(zero.monotonic_ns - time.monotonic_ns()) < 60e9
    assert abs(zero.unix_ns - time.time_ns()) < 60e9


def test_end():
    """end() works while the run waits for a reader, and later."""
    with Run() as run:
        threading.Timer(0.1, run.paced.end).start()
        run.paced.start(wait=True)
        run.paced.run(session())
    with Run() as run:
        threading.Timer(0.2, run.paced.end).start()
        run.paced.start()
        run.paced.run(session())


def test_requests_are_answered():
    """Answers have the order of requests."""
    with Run() as run, opened(run.started()) as port:
        os.write(port, BahrsCodec().encode(EnterDiagnostics(), 3))
        talk, data, until = session(), b'', 0.0
        while Acknowledgement(0xF0, 0) not in decoded(data) and until < 60.0:
            until += 0.3
            run.paced.run(talk, until)
            data += heard(port)
    assert Acknowledgement(0xF0, 0) in decoded(data)


def test_unplug_and_plug_in(tmp_path):
    """The link is removed and created again; a new reader gets data."""
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


def test_a_slow_reader_loses_bytes_and_blocks_nothing():
    """The lost bytes are counted."""
    with Run() as run, opened(run.started()):
        talk = session()
        talk.emulation.cable.send(0.0, bytes(1_000_000))
        talk.emulation.cable.byte_time = 1e-9
        run.paced.run(talk, 0.2)
        assert run.paced.lost > 500_000


def test_invalid_commands_end_nothing():
    """An invalid command of a scenario ends nothing either."""
    with control() as (commands, say), Run(commands=commands) as run:
        run.paced.start()
        say(b'nonsense\nfault rust=1\n')
        talk = session('0.05 integrity nose risk', '0.1 quit')
        run.paced.run(talk, 10.0)
    assert talk.emulation.ended
    assert len(run.complaints) == 3
    assert all(any(word in complaint for complaint in run.complaints)
               for word in ('nonsense', 'rust', 'nose'))


def test_lines_in_pieces():
    """The last line may lack its end."""
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


def test_a_file_gets_all_bytes():
    """Bytes that the adapter holds back are written, too."""
    results = set()
    for mode in ('none', 'packets', 0.016):
        file = io.BytesIO()
        run_to_file(Session(make_emulation(mode=mode)), 2.5, file)
        results.add(file.getvalue())
    assert len(results) == 1
    assert len(decoded(results.pop())) > 1.8 * 330

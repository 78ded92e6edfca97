# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of an emulation in real time, in this process, and of its control input."""

import contextlib
import io
import os
import threading
import time

from bahrs_driver.emulator.control_input import ControlInput
from bahrs_driver.emulator.runner import RealTimeRun, run_to_file
from bahrs_driver.emulator.scenario import parse
from bahrs_driver.emulator.session import EmulationSession
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import Acknowledgement, EnterDiagnostics, Inertial
import pytest
from support.emulated import decoded, make_device, make_emulation
from support.ports import opened


@contextlib.contextmanager
def control():
    """Return a control input and its writing end."""
    out, into = os.pipe()
    try:
        yield ControlInput(out), lambda text: os.write(into, text)
    finally:
        os.close(out)
        os.close(into)


def received(port):
    """Return all unread bytes of a port: one read may return fewer."""
    data = b''
    with contextlib.suppress(BlockingIOError):
        while True:
            data += os.read(port, 65536)
    return data


class Run:
    """A real-time run that records the names of ports, and errors of commands."""

    def __init__(self, link=None, commands=None):
        """Set the source of commands."""
        self.names, self.errors = [], []
        self.real_time = RealTimeRun(link, commands or ControlInput(None), self.names.append,
                                     self.errors.append)

    def started(self):
        """Start; return the port."""
        self.real_time.start()
        return self.names[-1]

    def __enter__(self):
        """Return the run itself."""
        return self

    def __exit__(self, *_):
        """Close the port."""
        self.real_time.close()


def session(*scenario, **behavior):
    """Return a session with a scenario."""
    return EmulationSession(make_emulation(make_device(**behavior)), parse(scenario))


def test_a_run_lasts_its_duration():
    """The bytes of a second take a second."""
    with Run() as run, opened(run.started()) as port:
        began = time.monotonic()
        run.real_time.run(session(), 1.0)
        assert time.monotonic() - began >= 1.0
        inertial = [message for message in decoded(received(port))
                    if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(80, abs=2)
    assert run.real_time.lost == 0


def test_a_late_process_catches_up():
    """All commands and samples are processed, even if the process slept meanwhile."""
    with Run() as run, opened(run.started()) as port:
        time.sleep(0.8)
        running = session('0.1 integrity nose risk', '0.6 quit')
        run.real_time.run(running, 0.7)
        inertial = [message for message in decoded(received(port))
                    if isinstance(message, Inertial)]
    assert len(inertial) == pytest.approx(20, abs=2)
    assert len(run.errors) == 1 and running.emulation.ended


def test_start_time_on_all_clocks():
    """Time starts at start()."""
    with Run() as run:
        start_time = run.real_time.start()
    assert abs(start_time.monotonic_ns - time.monotonic_ns()) < 60e9
    assert abs(start_time.unix_ns - time.time_ns()) < 60e9


def test_end():
    """end() works while the run waits for a reader, and later."""
    with Run() as run:
        threading.Timer(0.1, run.real_time.end).start()
        run.real_time.start(wait=True)
        run.real_time.run(session())
    with Run() as run:
        threading.Timer(0.2, run.real_time.end).start()
        run.real_time.start()
        run.real_time.run(session())


def test_requests_are_answered():
    """Answers have the order of requests."""
    with Run() as run, opened(run.started()) as port:
        os.write(port, BahrsCodec().encode(EnterDiagnostics(), 3))
        running, data, until = session(), b'', 0.0
        while Acknowledgement(0xF0, 0) not in decoded(data) and until < 60.0:
            until += 0.3
            run.real_time.run(running, until)
            data += received(port)
    assert Acknowledgement(0xF0, 0) in decoded(data)


def test_unplug_and_plug_in_again(tmp_path):
    """The link is removed and created again; a new reader gets data."""
    link = tmp_path / 'port'
    with Run(str(link)) as run:
        run.real_time.start()
        running = session('0.05 unplug 0.2')
        run.real_time.run(running, 0.15)
        assert not link.is_symlink()
        run.real_time.run(running, 0.4)
        assert link.is_symlink() and run.names == [str(link)] * 2
        with opened(link) as port:
            run.real_time.run(running, 1.0)
            assert decoded(received(port))
    assert not link.is_symlink()


def test_a_slow_reader_loses_bytes_and_does_not_block_the_run():
    """The lost bytes are counted."""
    with Run() as run, opened(run.started()):
        running = session()
        running.emulation.cable.send(0.0, bytes(1_000_000))
        running.emulation.cable.byte_time = 1e-9
        run.real_time.run(running, 0.2)
        assert run.real_time.lost > 500_000


def test_invalid_commands_do_not_end_the_run():
    """Neither those of the user, nor those of a scenario."""
    with control() as (commands, say), Run(commands=commands) as run:
        run.real_time.start()
        say(b'nonsense\nfault rust=1\n')
        running = session('0.05 integrity nose risk', '0.1 quit')
        run.real_time.run(running, 10.0)
    assert running.emulation.ended
    assert len(run.errors) == 3
    assert all(any(word in error for error in run.errors)
               for word in ('nonsense', 'rust', 'nose'))


def test_lines_in_pieces():
    """The last line may lack its end."""
    with control() as (commands, say):
        say(b'first\nsec')
        assert commands.read_lines() == ['first']
        say(b'ond\nthird\n')
        assert commands.read_lines() == ['second', 'third']
    out, into = os.pipe()
    os.write(into, b'last')
    os.close(into)
    commands = ControlInput(out)
    assert commands.read_lines() == []
    assert commands.read_lines() == ['last'] and commands.descriptor is None
    assert commands.read_lines() == []
    os.close(out)


def test_a_file_gets_all_bytes():
    """Bytes that the adapter holds back are written, too."""
    results = set()
    for mode in ('none', 'packets', 0.016):
        file = io.BytesIO()
        run_to_file(EmulationSession(make_emulation(mode=mode)), 2.5, file)
        results.add(file.getvalue())
    assert len(results) == 1
    assert len(decoded(results.pop())) > 1.8 * 330

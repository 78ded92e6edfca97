# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs report`."""

from argparse import Namespace
import json

from bahrs_driver.cli.report import _target
import pytest
from support.emulated import make_emulation, on_the_wire
from support.in_process import run_bahrs


def report(*words):
    """Run the verb; return exit status, output and errors."""
    return run_bahrs('report', *words)


@pytest.fixture(scope='module')
def flight(tmp_path_factory):
    """Return a file with a few seconds of a stream."""
    path = tmp_path_factory.mktemp('report') / 'flight.bin'
    path.write_bytes(on_the_wire(make_emulation(), 5.0)[1])
    return path


@pytest.mark.slow
def test_a_page_beside_the_recording(flight):
    """Only its name is printed."""
    status, text, complaints = report(flight)
    assert (status, complaints) == (0, '')
    target = flight.with_suffix('.html')
    assert text == f'{target}\n'
    assert target.read_text().startswith('<!DOCTYPE html>')


def test_json(flight):
    """The output has counts and findings, and no page is written."""
    status, text, complaints = report(flight, '--json')
    assert (status, complaints) == (0, '')
    found = json.loads(text)
    assert found['counts']['inertial'] > 800 and found['crc_failures'] == 0
    assert {finding['level'] for finding in found['findings']} <= {
        'good', 'notice', 'warning', 'error'}


def test_errors(tmp_path, flight):
    """Each is one sentence."""
    noise = tmp_path / 'noise.bin'
    noise.write_bytes(bytes(1000))
    for words, sentence in (
            ((tmp_path / 'nothing.bin',), 'No such file'),
            ((noise,), 'no frame of a BAHRS in the 1,000 bytes'),
            ((flight, '-o', tmp_path / 'no' / 'page.html'), 'cannot write')):
        status, text, complaints = report(*words)
        assert (status, text) == (1, '')
        assert complaints.startswith('bahrs report: ') and sentence in complaints
        assert complaints.count('\n') == 1


def test_a_directory_named_by_a_dot(tmp_path, monkeypatch):
    """The page has the name of the directory."""
    monkeypatch.chdir(tmp_path)
    status, _, complaints = report('.')
    assert status == 1 and 'is not a bag' in complaints
    assert _target(Namespace(output=None, input='.')) == tmp_path.with_suffix('.html')


def test_the_recording_is_never_overwritten(flight):
    """A page with its name is refused."""
    before = flight.read_bytes()
    status, _, complaints = report(flight, '-o', flight)
    assert (status, complaints) == (
        1, f'bahrs report: {flight} is the recording itself: give the page another name\n')
    assert flight.read_bytes() == before

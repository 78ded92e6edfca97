# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the page: complete, self-contained, with all figures."""

import base64
from dataclasses import replace
from html.parser import HTMLParser
import re
from xml.etree import ElementTree

from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.emulator.flights import SteadyTurn
from bahrs_driver.emulator.measurement_errors import DEVIATIONS, MeasurementErrors
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.bahrs.messages import SoftwareVersion
from bahrs_driver.report.page import page
from hypothesis import given, settings, strategies as st
import pytest
from support.emulated import make_device, make_emulation
from support.recorded import gathered, recorded
from support.shared_files import shared_file

VOID = {'meta', 'img', 'br', 'link'}


class ParsedPage(HTMLParser):
    """The headings, figures (by their titles) and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.open, self.headings, self.figures, self.text = [], [], {}, ''
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        """Handle the beginning of an element."""
        given = dict(attrs)
        assert tag != 'script' and 'href' not in given
        if tag not in VOID:
            self.open.append(tag)
        if tag == 'img':
            kind, _, data = given['src'].partition(',')
            assert kind == 'data:image/svg+xml;base64'
            self.figures[given['alt']] = ElementTree.fromstring(base64.b64decode(data))

    def handle_endtag(self, tag):
        """Handle the end of an element."""
        assert self.open.pop() == tag

    def handle_data(self, data):
        """Handle text."""
        self.text += data
        if self.open[-1:] == ['h2']:
            self.headings.append(data)


@pytest.fixture(scope='module')
def at_rest():
    """Return the page about a noisy device at rest."""
    return ParsedPage(''.join(page(recorded(make_emulation(make_device(
        errors=MeasurementErrors(1, DEVIATIONS), version=3)), seconds=75.0))))


@pytest.mark.slow
def test_every_section_is_there(at_rest):
    """Each has its figures."""
    sections = ['Findings', 'Integrity', 'Data rate', 'Specific force and angular rate',
                'Attitude and heading', 'Height and vertical speed', 'Accuracy', 'Clock']
    assert at_rest.headings[:len(sections)] == sections
    assert at_rest.headings[-1].startswith('Noise at rest, 7')
    assert len(at_rest.figures) == 9
    assert 'made_up.bin' in at_rest.text and 'read from 2023-11-14 22:13:20 UTC on' in at_rest.text


def test_angle_random_walk(at_rest):
    """N of the angular rate is that of the emulator's noise."""
    row = at_rest.text.split('angle random walk [°/√h]')[1].split()[0]
    density = DEVIATIONS['angular_rate'] * 0.005 ** 0.5         # rad/s * sqrt(s)
    assert float(row[:6]) == pytest.approx(density * 57.29578 * 60, rel=0.15)


def test_flight_without_rest():
    """The page gives the reason why noise is not analyzed."""
    flight = recorded(make_emulation(make_device(SteadyTurn())), 5.0, timed=False)
    parsed = ParsedPage(''.join(page(flight)))
    assert parsed.headings[-1] == 'Noise at rest'
    assert 'the longest rest of the device is 0 s, and 60 s are needed' in parsed.text
    assert 'so offset, drift and delays are unknown' in parsed.text


@pytest.mark.slow
def test_noise_of_the_real_recording():
    """Four minutes are too short for K, and the line at half the sample rate is left out."""
    text = ''.join(page(gathered(open_capture(shared_file('data/bahrs_recording_v2.bin')))))
    rows = {name: tuple(re.findall('<td>(.*?)</td>', cells)) for name, cells in re.findall(
        '<tr><td>([^<]*)</td>((?:<td>[^<]*</td>){3})</tr>', text)}
    for name in ('rate: K, rate random walk [°/h/√h]', 'force: K, random walk [m/s²/√h]'):
        assert all(re.fullmatch(r'rest too short, needs \d+ min', cell) for cell in rows[name])
    assert rows['rate: strongest line [Hz]'] == ('91.3', '43.2', 'none')
    assert rows['force: strongest line [Hz]'] == ('22.9', '22.9', '43.2')
    assert all(float(cell) > 0 for cell in rows['rate: N, angle random walk [°/√h]'])
    assert 'A line may be an alias: with 200 samples a second' in text
    assert 'The line at 100 Hz, half the sample rate, is left out' in text


@settings(max_examples=20)
@given(name=st.text(st.characters(), min_size=1), project=st.text(max_size=5),
       note=st.text())
def test_untrusted_text(name, project, note):
    """Markup and control characters in a recording are shown as text."""
    foreign = replace(recorded(seconds=0.1, timed=False), name=f'<i>{name}', notes=[f'</b>{note}'],
                      software=SoftwareVersion(f'&{project}', 1, 2))
    text = ''.join(page(foreign))
    text.encode()
    assert all(character.isprintable() or character == '\n' for character in text)
    outline = ParsedPage(text)
    assert printable(f'<i>{name}') in outline.text
    assert printable(f'</b>{note}') in outline.text
    assert printable(f'&{project} 1.2') in outline.text

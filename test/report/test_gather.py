# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the arrays, the clock analysis and the findings of a recording."""

from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.protocol.bahrs.messages import Inertial
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.clock import analyze_clock
from bahrs_driver.report.findings import ERROR, findings, GOOD, NOTICE, WARNING
from bahrs_driver.report.time_axis import BreakKind
from bahrs_driver.virtual_serial.cable import adapter_mode
import numpy as np
import pytest
from support.emulated import make_device, make_emulation
from support.recorded import EmulatedCapture, gathered, recorded
from support.shared_files import shared_file


def sentences(recording, severity=None):
    """Return the findings of a severity, or all, one per line."""
    return '\n'.join(text for each, text in findings(recording, analyze_clock(recording))
                     if severity in (None, each))


def test_undamaged_recording():
    """All messages are counted, and no finding is a warning."""
    recording = recorded(seconds=20.0)
    assert recording.counters.crc_failures == 0
    assert recording.duration == pytest.approx(19.4, abs=0.2)
    assert len(recording.inertial.seconds) == recording.counts['inertial']
    assert recording.inertial.values['specific_force'].mean(axis=0) == pytest.approx(
        [0, 0, -9.81], abs=0.02)
    assert recording.navigation.seconds[1:5] - recording.navigation.seconds[:4] == pytest.approx(
        0.01)
    assert recording.software.project == 'EMU' and recording.hardware is not None
    assert sentences(recording, ERROR) == sentences(recording, WARNING) == ''
    for sentence in ('frames are intact', 'No inertial sample is missing',
                     'name the sample after'):
        assert sentence in sentences(recording, GOOD)
    # As the real device, it has no navigation solution for the first moments.
    assert sentences(recording, NOTICE).startswith(
        'Pressure height, velocity down, roll, pitch and magnetic heading: unavailable for the '
        'first 0.08 s.')


def test_without_times_of_reads():
    """The clocks cannot be compared."""
    recording = recorded(timed=False)
    assert recording.reads is None and analyze_clock(recording) is None
    assert recording.duration > 9.0


@pytest.mark.parametrize('drift', [-80.0, 150.0])
def test_clock_drift(drift):
    """The estimated drift is that of the emulator's clock."""
    recording = recorded(make_emulation(make_device(drift_ppm=drift)), seconds=40.0)
    analysis = analyze_clock(recording)
    assert analysis.drift_ppm == pytest.approx(drift, abs=5.0)
    assert 0.0 <= analysis.delay.min() and analysis.delay_99 < 0.008
    assert ('drifts' in sentences(recording, WARNING)) == (abs(drift) > 100)


def test_adapter_with_a_long_latency_timer():
    """Findings report the sizes of reads and the delays of samples."""
    recording = recorded(make_emulation(mode=adapter_mode('40')), every=0.002, seconds=20.0)
    text = sentences(recording, NOTICE)
    assert 'timer of 1 ms' in text and 'One of 100 samples arrives more than' in text


def test_step_of_the_host_clock():
    """The step is counted, and does not change the delays."""
    class Stepped(EmulatedCapture):
        def chunks(self):
            for chunk in super().chunks():
                late = chunk.ros_ns > 1_700_000_015_000_000_000
                yield chunk._replace(ros_ns=chunk.ros_ns + 5_000_000_000 * late)

    analysis = analyze_clock(gathered(Stepped(make_emulation(), 30.0)))
    assert analysis.host_steps == 1 and analysis.delay_99 < 0.02


def test_stalled_host():
    """A stall is neither a step nor a drift of the clock."""
    class Stalled(EmulatedCapture):
        def chunks(self):
            held, until = b'', 1_700_000_018_000_000_000
            for chunk in super().chunks():
                at, held = chunk.ros_ns, held + chunk.data
                if not until - 1_500_000_000 < at < until:
                    yield chunk._replace(data=held, raw_ns=at - 10 ** 18)
                    held = b''

    analysis = analyze_clock(gathered(Stalled(make_emulation(make_device(drift_ppm=40.0)), 30.0)))
    assert analysis.host_steps == 0 and analysis.drift_ppm == pytest.approx(40.0, abs=5.0)
    assert 1.4 < analysis.longest_pause < 1.6
    assert analysis.delay.max() == pytest.approx(1.5, abs=0.02)


def test_step_of_the_host_clock_with_raw_times():
    """A step of 2 ms against CLOCK_MONOTONIC_RAW is counted, whatever the delays."""
    class Stepped(EmulatedCapture):
        def chunks(self):
            for chunk in super().chunks():
                late = chunk.ros_ns > 1_700_000_015_000_000_000
                yield chunk._replace(ros_ns=chunk.ros_ns - 2_000_000 * late,
                                     raw_ns=chunk.ros_ns - 10 ** 18)

    analysis = analyze_clock(gathered(Stepped(make_emulation(), 30.0)))
    assert analysis.host_steps == 1 and analysis.delay_99 < 0.02


def test_losses_and_damage():
    """Damaged frames and missing samples are counted."""
    emulation = make_emulation(bit_flip=0.0002, drop_frame=0.01)
    recording = recorded(emulation, seconds=30.0)
    assert recording.counters.crc_failures > 0
    text = sentences(recording, WARNING)
    assert 'damaged frames' in text and 'inertial samples are missing' in text
    whole = int(recording.inertial.seconds[-1] / 0.005 + 0.5) + 1
    lost = sum(gap.missing for gap in recording.time_axis.breaks)
    assert lost == whole - len(recording.inertial.seconds)


def test_integrity_findings():
    """Signals that were unsafe at the same times share a finding."""
    emulation = make_emulation()
    made = EmulatedCapture(emulation, 20.0)
    signals = emulation.device.signals

    plan = [(5.0, signals[:3], Integrity.UNAVAILABLE), (8.0, signals[:3], Integrity.SAFE),
            (10.0, ('roll',), Integrity.INTEGRITY_RISK), (10.5, ('roll',), Integrity.SAFE)]
    advance = emulation.advance

    def advance_as_planned(until):
        while plan and plan[0][0] <= until:
            emulation.device.set_integrity(*plan.pop(0)[1:])
        return advance(until)

    emulation.advance = advance_as_planned
    recording = gathered(made)
    assert 'Specific force: unavailable for 3.00 s from 0:04.4.' in sentences(recording, WARNING)
    assert 'Roll: integrity risk for 0.50 s from 0:09.4.' in sentences(recording, NOTICE)
    assert recording.inertial.names == Inertial.SIGNALS


def test_saturation():
    """A finding reports a quantity at the limit of its range."""
    loud = MeasurementErrors(1, {'angular_rate': 3.0}, {'angular_rate': (5.0, 0.0, 0.0)})
    assert 'The angular rate is at the limit of its range' in sentences(
        recorded(make_emulation(make_device(errors=loud))), WARNING)


def test_restart():
    """Times continue after a restart, and no sample counts as lost."""
    emulation = make_emulation()
    advance = emulation.advance
    once = [10.0]

    def advance_with_restart(until):
        if once and until >= once[0]:
            emulation.device.power_cycle(once.pop())
        return advance(until)

    emulation.advance = advance_with_restart
    recording = recorded(emulation, seconds=20.0)
    assert 'The device restarted before 0:' in sentences(recording, WARNING)
    assert [found.kind for found in recording.time_axis.breaks] == [BreakKind.RESTARTED]
    assert np.all(np.diff(recording.time_axis.seconds) > 0)


def test_real_recording():
    """The device is at rest, has no heading, and paused once."""
    recording = gathered(open_capture(shared_file('data/bahrs_recording_v2.bin')))
    assert recording.counts['inertial'] == 47_837 and recording.versions == {2: 78_932}
    assert 'Magnetic heading: unavailable throughout.' in sentences(recording, WARNING)
    assert 'nothing for 2.7 s' in sentences(recording, NOTICE)
    assert 'No inertial sample is missing.' in sentences(recording, GOOD)
    assert recording.time_axis.label_ahead == 1

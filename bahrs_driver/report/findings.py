# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Describe a recording in findings, the worst first."""

from collections.abc import Iterator

from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.clock import ClockAnalysis
from bahrs_driver.report.finding import clock_time, ERROR, Finding, GOOD, NOTICE, Severity, WARNING
from bahrs_driver.report.gather import Recording, Signals
from bahrs_driver.report.integrity import integrity_findings
from bahrs_driver.report.time_axis import Array, BreakKind, UNKNOWN_PAUSE
import numpy as np

CUT_OFF = 64                # bytes of cut frames at the beginning and end of a recording
MANY = 5                    # events named one by one
DRIFT_LIMIT = 100.0         # ppm; more is a defect of a crystal
LATE_LIMIT = 0.02           # s of delay that 99 of 100 samples should not exceed
LONG_READ = 60              # bytes a read, above which an adapter holds bytes back
INERTIAL_RATE, NAVIGATION_RATE = 200.0, 100.0       # Hz
RATE_TOLERANCE = 0.02


def findings(recording: Recording, analysis: ClockAnalysis | None) -> list[Finding]:
    """Return all findings, the worst first."""
    found = [*_framing(recording), *_breaks(recording), *_rates(recording),
             *integrity_findings(recording), *_saturation(recording),
             *_time_messages(recording), *(_clock(analysis) if analysis else ()),
             *_device(recording), *(Finding(WARNING, printable(note)) for note in recording.notes)]
    return sorted(found, key=lambda finding: list(Severity).index(finding.level))


def _framing(recording: Recording) -> Iterator[Finding]:
    counters = recording.counters
    if counters.crc_failures or counters.skipped_bytes > CUT_OFF:
        share = counters.crc_failures / (counters.crc_failures + counters.frames)
        yield Finding(
            ERROR if share > 0.1 else WARNING,
            f'{counters.crc_failures:,} damaged frames ({share:.2%}) and '
            f'{counters.skipped_bytes:,} bytes outside of frames: check cable, ground and '
            'baud rate.')
    else:
        rest = f'{counters.skipped_bytes} bytes are left over: a recording may begin or end ' \
               'within a frame' if counters.skipped_bytes else 'no byte is left over'
        yield Finding(GOOD, f'All {counters.frames:,} frames are intact; {rest}.')
    if counters.unknown_types:
        names = ', '.join(f'{printable(name)} ({count:,})'
                          for name, count in counters.unknown_types.items())
        yield Finding(NOTICE, f'Intact frames of unknown type: {names}.')


def _breaks(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    lost = [found for found in axis.breaks if found.kind is BreakKind.LOST]
    if lost:
        missing = sum(found.missing for found in lost)
        share = missing / (missing + len(axis.seconds))
        worst = max(lost, key=lambda found: found.missing)
        yield Finding(WARNING, f'{missing:,} inertial samples are missing ({share:.2%}), at '
                      f'{len(lost):,} places; the longest gap is {worst.seconds:.3f} s at '
                      f'{clock_time(axis.seconds[worst.index])}.')
    else:
        yield Finding(GOOD, 'No inertial sample is missing.')
    yield from _pauses(recording)
    yield from _restarts(recording)
    if axis.rejected:
        yield Finding(NOTICE, f'{axis.rejected:,} time messages contradict those around them.')


def _pauses(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    pauses = [found for found in axis.breaks if found.kind is BreakKind.PAUSED]
    if len(pauses) > MANY:
        total = sum(found.seconds for found in pauses)
        longest = max(pauses, key=lambda found: found.seconds)
        yield Finding(NOTICE, f'The device sent nothing for {total:.1f} s in {len(pauses):,} '
                      f'pauses, the longest {longest.seconds:.1f} s before '
                      f'{clock_time(axis.seconds[longest.index])}, and counted no samples '
                      'meanwhile.')
        return
    for found in pauses:
        yield Finding(NOTICE, f'The device sent nothing for {found.seconds:.1f} s before '
                      f'{clock_time(axis.seconds[found.index])}, and counted no samples '
                      'meanwhile.')


def _restarts(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    times = [clock_time(axis.seconds[found.index]) for found in axis.breaks
             if found.kind is BreakKind.RESTARTED]
    if times:
        named = ', '.join(times[:MANY]) + (f' and {len(times) - MANY:,} times more, the last '
                                           f'before {times[-1]}' if len(times) > MANY else '')
        yield Finding(WARNING, f'The device restarted before {named}. How long it was off is not '
                      f'recorded: {UNKNOWN_PAUSE:.0f} s is drawn.')


def _rates(recording: Recording) -> Iterator[Finding]:
    paused = sum(found.seconds for found in recording.time_axis.breaks
                 if found.kind is not BreakKind.LOST)
    flowing = recording.duration - paused
    if flowing < 1.0:
        yield Finding(WARNING, f'There is only {recording.duration:.1f} s of data.')
        return
    for signals, name, nominal in ((recording.inertial, 'inertial', INERTIAL_RATE),
                                   (recording.navigation, 'navigation', NAVIGATION_RATE)):
        rate = len(signals.seconds) / flowing
        if abs(rate / nominal - 1) > RATE_TOLERANCE:
            yield Finding(WARNING, f'{name.capitalize()} messages come {rate:.1f} times a second '
                                   f'instead of {nominal:.0f}.')


def _saturation(recording: Recording) -> Iterator[Finding]:
    inertial, navigation = recording.inertial, recording.navigation
    for signals, field, name in (
            (inertial, 'specific_force', 'specific force'),
            (inertial, 'angular_rate', 'angular rate'),
            (navigation, 'velocity_down', 'vertical velocity')):
        yield from _at_limit(_saturated(recording, signals, field), name)
    safe = navigation.health[:, 0] == Integrity.SAFE
    yield from _at_limit(safe & _saturated(recording, navigation, 'pressure_height'),
                         'pressure height')


def _saturated(recording: Recording, signals: Signals, field: str) -> Array:
    lowest, highest = recording.limits[field]
    values = signals.values[field]
    return np.asarray((values <= lowest) | (values >= highest))


def _at_limit(where: Array, name: str) -> Iterator[Finding]:
    count = int(where.any(axis=1).sum() if where.ndim > 1 else where.sum())
    if count:
        yield Finding(WARNING, f'The {name} is at the limit of its range in {count:,} samples: '
                               'the true value is larger.')


def _time_messages(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    if axis.label_ahead is None:
        yield Finding(WARNING, 'There is no inertial time message: the times of samples are '
                               'multiples of the nominal period.')
    elif axis.label_ahead == 1:
        yield Finding(GOOD, 'Time messages name the sample after the one that they refer to, '
                            'as known devices do; the driver detects this.')
    elif axis.label_ahead == 0:
        yield Finding(NOTICE, 'Time messages name the sample just sent, as the document says.')
    else:
        yield Finding(WARNING, f'Time messages name a sample {axis.label_ahead} ahead of the one '
                               'just sent, which no known device does.')


def _clock(analysis: ClockAnalysis) -> Iterator[Finding]:
    if analysis.drift_ppm is not None and abs(analysis.drift_ppm) > DRIFT_LIMIT:
        yield Finding(WARNING, f"The device's clock drifts {analysis.drift_ppm:+.1f} ppm against "
                               f"the host's, more than {DRIFT_LIMIT:.0f}: one of them is "
                               'defective.')
    if analysis.late_99 > LATE_LIMIT:
        yield Finding(NOTICE, 'One of 100 samples arrives more than '
                              f'{analysis.late_99 * 1e3:.0f} ms late: the host was busy, or the '
                              'adapter holds bytes back.')
    if analysis.read_bytes > LONG_READ:
        yield Finding(NOTICE, f'Reads return {analysis.read_bytes} bytes at a time: a latency '
                              'timer of 1 ms reduces the delay ("bahrs doctor" prints the '
                              'command).')
    if analysis.host_steps:
        yield Finding(WARNING, f"The host's clock was set {analysis.host_steps} times.")


def _device(recording: Recording) -> Iterator[Finding]:
    if recording.software is None:
        yield Finding(NOTICE, 'There is no software version: the device sends it only at '
                              'power-on, so the recording began later, or its version is old.')
    if len(recording.versions) > 1:
        yield Finding(WARNING, 'Frames of several protocol versions are mixed: '
                      + ', '.join(f'{count:,} of version {version}'
                                  for version, count in sorted(recording.versions.items())) + '.')
    if recording.openings > 1:
        yield Finding(NOTICE, f'The port was opened {recording.openings} times while this was '
                              'recorded.')

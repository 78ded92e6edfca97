# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Describe a recording in findings, the worst first."""

from collections.abc import Iterator

from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.clock import ClockAnalysis
from bahrs_driver.report.finding import ERROR, Finding, GOOD, NOTICE, Severity, time_text, WARNING
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.integrity import integrity_findings
from bahrs_driver.report.time_axis import Break, BreakKind, TimeAxis, UNKNOWN_PAUSE

MAX_CUT_BYTES = 64          # of cut frames at the beginning and end of a recording
MAX_DAMAGED_SHARE = 0.1     # of frames, above which it is an error
MAX_LISTED = 5              # events listed one by one
MAX_DRIFT = 100.0           # ppm; more is a defect of a crystal
MAX_DELAY = 0.02            # s; 99 of 100 samples should not exceed it
MAX_READ = 60               # bytes, above which an adapter holds bytes back
MIN_DURATION = 1.0          # s of data, for a rate
RATE_TOLERANCE = 0.02


def findings(recording: Recording, analysis: ClockAnalysis | None) -> list[Finding]:
    """Return all findings, the worst first."""
    found = [*_framing(recording), *_lost_samples(recording), *_pauses(recording),
             *_restarts(recording), *_rates(recording), *integrity_findings(recording),
             *_saturation(recording), *_time_messages(recording.time_axis),
             *(_clock(analysis) if analysis else ()), *_device(recording),
             *(Finding(WARNING, printable(note)) for note in recording.notes)]
    return sorted(found, key=lambda finding: list(Severity).index(finding.severity))


def _framing(recording: Recording) -> Iterator[Finding]:
    counters = recording.counters
    if counters.crc_failures or counters.skipped_bytes > MAX_CUT_BYTES:
        share = counters.crc_failures / (counters.crc_failures + counters.frames)
        yield Finding(
            ERROR if share > MAX_DAMAGED_SHARE else WARNING,
            f'{counters.crc_failures:,} damaged frames ({share:.2%}) and '
            f'{counters.skipped_bytes:,} bytes outside of frames: check cable, ground and '
            'baud rate.')
    else:
        outside = f'{counters.skipped_bytes} bytes are outside of frames, as the recording ' \
                  'begins or ends within one' if counters.skipped_bytes else \
                  'no byte is outside of them'
        yield Finding(GOOD, f'All {counters.frames:,} frames are intact; {outside}.')
    if counters.unknown_types:
        names = ', '.join(f'{printable(name)} ({count:,})'
                          for name, count in counters.unknown_types.items())
        yield Finding(NOTICE, f'Intact frames of unknown type: {names}.')


def _lost_samples(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    gaps = _breaks(axis, BreakKind.LOST)
    if not gaps:
        yield Finding(GOOD, 'No inertial sample is missing.')
        return
    missing = sum(gap.missing for gap in gaps)
    share = missing / (missing + len(axis.seconds))
    longest = max(gaps, key=lambda gap: gap.missing)
    yield Finding(WARNING, f'{missing:,} inertial samples are missing ({share:.2%}), at '
                  f'{len(gaps):,} places; the longest gap is {longest.seconds:.3f} s at '
                  f'{time_text(axis.seconds[longest.index])}.')


def _pauses(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    pauses = _breaks(axis, BreakKind.PAUSED)
    if len(pauses) > MAX_LISTED:
        total = sum(pause.seconds for pause in pauses)
        longest = max(pauses, key=lambda pause: pause.seconds)
        silences = [f'{total:.1f} s in {len(pauses):,} pauses, the longest '
                    f'{longest.seconds:.1f} s before {time_text(axis.seconds[longest.index])}']
    else:
        silences = [f'{pause.seconds:.1f} s before {time_text(axis.seconds[pause.index])}'
                    for pause in pauses]
    for silence in silences:
        yield Finding(NOTICE, f'The device sent nothing for {silence}, and its sample counter '
                              'stood still.')


def _restarts(recording: Recording) -> Iterator[Finding]:
    axis = recording.time_axis
    times = [time_text(axis.seconds[restart.index])
             for restart in _breaks(axis, BreakKind.RESTARTED)]
    if times:
        listed = ', '.join(times[:MAX_LISTED])
        if len(times) > MAX_LISTED:
            listed += f' and {len(times) - MAX_LISTED:,} times more, the last before {times[-1]}'
        yield Finding(WARNING, f'The device restarted before {listed}. How long it was off is not '
                               f'recorded: {UNKNOWN_PAUSE:.0f} s is drawn.')


def _breaks(axis: TimeAxis, kind: BreakKind) -> list[Break]:
    return [found for found in axis.breaks if found.kind is kind]


def _rates(recording: Recording) -> Iterator[Finding]:
    paused = sum(found.seconds for found in recording.time_axis.breaks
                 if found.kind is not BreakKind.LOST)
    sending = recording.duration - paused
    if sending < MIN_DURATION:
        yield Finding(WARNING, f'There is only {recording.duration:.1f} s of data.')
        return
    for name, signals in (('Inertial', recording.inertial), ('Navigation', recording.navigation)):
        rate = len(signals.seconds) / sending
        if abs(rate / signals.rate - 1) > RATE_TOLERANCE:
            yield Finding(WARNING, f'{name} messages arrive {rate:.1f} times a second instead of '
                                   f'{signals.rate:.0f}.')


def _saturation(recording: Recording) -> Iterator[Finding]:
    for signals, field, name in (
            (recording.inertial, 'specific_force', 'specific force'),
            (recording.inertial, 'angular_rate', 'angular rate'),
            (recording.navigation, 'velocity_down', 'vertical velocity'),
            (recording.navigation, 'pressure_height', 'pressure height')):
        lowest, highest = recording.limits[field]
        values = signals.values[field]
        saturated = (values <= lowest) | (values >= highest)
        if field == 'pressure_height':
            saturated &= signals.health[:, signals.names.index(field)] == Integrity.SAFE
        # A vector counts once.
        count = int(saturated.any(axis=tuple(range(1, saturated.ndim))).sum())
        if count:
            yield Finding(WARNING, f'The {name} is at the limit of its range in {count:,} '
                                   'samples: the true value is larger.')


def _time_messages(axis: TimeAxis) -> Iterator[Finding]:
    if axis.label_ahead is None:
        yield Finding(WARNING, 'There is no inertial time message: the times of samples are '
                               'multiples of the nominal period.')
    elif axis.label_ahead == 1:
        yield Finding(GOOD, 'Time messages name the sample after the one whose time they give, '
                            'as all known devices do; the driver detects and corrects this.')
    elif axis.label_ahead == 0:
        yield Finding(NOTICE, 'Time messages name the sample just sent, as the document says.')
    else:
        yield Finding(WARNING, f'Time messages name a sample {axis.label_ahead} ahead of the one '
                               'just sent, which no known device does.')


def _clock(analysis: ClockAnalysis) -> Iterator[Finding]:
    if analysis.drift_ppm is not None and abs(analysis.drift_ppm) > MAX_DRIFT:
        yield Finding(WARNING, f"The device's clock drifts {analysis.drift_ppm:+.1f} ppm against "
                               f"the host's, more than {MAX_DRIFT:.0f}: one of them is "
                               'defective.')
    if analysis.delay_99 > MAX_DELAY:
        yield Finding(NOTICE, 'One of 100 samples arrives more than '
                              f'{analysis.delay_99 * 1e3:.0f} ms late: the host was busy, or the '
                              'adapter holds bytes back.')
    if analysis.read_bytes > MAX_READ:
        yield Finding(NOTICE, f'Reads return {analysis.read_bytes} bytes at a time: a latency '
                              'timer of 1 ms reduces the delay ("bahrs doctor" prints the '
                              'command).')
    if analysis.host_steps:
        yield Finding(WARNING, f"The host's clock was set {analysis.host_steps} times.")


def _device(recording: Recording) -> Iterator[Finding]:
    if recording.software is None:
        yield Finding(NOTICE, 'No software version was received: the device sends it only at '
                              'power-on, so the recording began later, or the device is too old '
                              'to send it.')
    if len(recording.versions) > 1:
        yield Finding(WARNING, 'Frames of several protocol versions are mixed: '
                      + ', '.join(f'{count:,} of version {version}'
                                  for version, count in sorted(recording.versions.items())) + '.')
    if recording.openings > 1:
        yield Finding(NOTICE, f'The port was opened {recording.openings} times while this was '
                              'recorded.')

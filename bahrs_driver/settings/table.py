# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Every parameter of the node, in one table.

The table is what the node declares, what `ros2 param describe` shows, and what the README lists.
Parameters are read once, when the driver starts, except for those that a service reads when it is
called.
"""

from typing import Any

from bahrs_driver.settings.parameter import Parameter

BAHRS, TITAN_M = 'bahrs', 'titan_m'

PARAMETERS = (
    Parameter('sensor', 'bahrs', 'Which device is on the port.',
              choices=(BAHRS, TITAN_M)),
    Parameter('port', '/dev/ttyUSB0',
              'Serial port: a path, or a URL such as socket://host:4001, rfc2217://host:4001 or '
              'hwgrep://0403:6001.'),
    Parameter('baud_rate', 115200, 'Speed of the serial line. Always 8N1.', 'baud',
              low=1200, high=4000000),
    Parameter('frame_id', 'imu_link', 'Frame of the sensor, in which body vectors are given.',
              is_frame=True),
    Parameter('world_frame_id', 'map',
              'Frame of altitude/pose, velocity and odometry, level with its z axis vertical.',
              is_frame=True),
    Parameter('frame_convention', 'enu',
              'Axes of what is published: enu for body forward, left, up and world east, north, '
              'up (REP-103); ned for body forward, right, down and world north, east, down.',
              choices=('enu', 'ned')),
    Parameter('stddev.specific_force', 0.01,
              'Standard deviation of each component of the specific force. The default is what '
              'a device at rest shows; a vibrating airframe needs more. 0 is unknown.', 'm/s^2',
              low=0.0, high=100.0),
    Parameter('stddev.angular_rate', 0.0005,
              'Standard deviation of each component of the angular rate. The default is what a '
              'device at rest shows; 0 is unknown.', 'rad/s', low=0.0, high=10.0),
    Parameter('stddev.orientation_fallback', 0.1,
              'Standard deviation of the orientation of a bahrs about each axis while the device '
              'reports no accuracy. 0 is unknown: the covariance is then all zeros, which some '
              'filters take for certainty.', 'rad', low=0.0, high=4.0, sensor=BAHRS),
    Parameter('stddev.pressure_height', 1.0,
              'Standard deviation of the pressure height; 0 is unknown.', 'm',
              low=0.0, high=1000.0, sensor=BAHRS),
    Parameter('stddev.velocity', 0.2,
              'Standard deviation of the velocity: of a bahrs the vertical one, of a titan_m each '
              'component; 0 is unknown.', 'm/s', low=0.0, high=100.0),
    Parameter('stddev.attitude', 0.02,
              'Standard deviation of roll and pitch of a titan_m. Nobody has measured it; 0 is '
              'unknown.', 'rad', low=0.0, high=4.0, sensor=TITAN_M),
    Parameter('stddev.heading', 0.05,
              'Standard deviation of the heading of a titan_m. Nobody has measured it; 0 is '
              'unknown.', 'rad', low=0.0, high=4.0, sensor=TITAN_M),
    Parameter('stddev.position', 2.5,
              'Standard deviation of each horizontal component of a position by GPS; 0 is '
              'unknown.', 'm',
              low=0.0, high=1000.0, sensor=TITAN_M),
    Parameter('stddev.altitude', 5.0,
              'Standard deviation of an altitude by GPS; 0 is unknown.', 'm',
              low=0.0, high=1000.0, sensor=TITAN_M),
    Parameter('stddev.magnetic_field', 0.0,
              'Standard deviation of each component of a measured magnetic field; 0 is unknown.',
              'T', low=0.0, high=1e-3, sensor=TITAN_M),
    Parameter('stddev.static_pressure', 0.0,
              'Standard deviation of a measured static pressure; 0 is unknown.', 'Pa',
              low=0.0, high=1e5, sensor=TITAN_M),
    Parameter('stddev.differential_pressure', 0.0,
              'Standard deviation of the differential pressure; 0 is unknown.', 'Pa',
              low=0.0, high=1e5, sensor=TITAN_M),
    Parameter('stddev.temperature', 0.0,
              'Standard deviation of the temperature; 0 is unknown.', 'K', low=0.0, high=100.0,
              sensor=TITAN_M),
    Parameter('magnetic_field.declination', 0.0,
              'Magnetic declination, positive east. It is added to the magnetic heading to give '
              'the yaw of imu/data and odometry, and the accuracy of a bahrs is rotated with it; '
              'the topic heading stays as the device has it.',
              'degree',
              low=-180.0, high=180.0),
    Parameter('magnetic_field.strength', 50e-6,
              'Strength of the magnetic field that imu/mag is derived with.', 'T',
              low=0.0, high=1e-3, sensor=BAHRS, needs={'publish.derived_magnetic_field': (True,)}),
    Parameter('magnetic_field.dip', 0.0,
              'Dip of the magnetic field that imu/mag is derived with, positive downward; 0 gives '
              'a horizontal field.', 'degree', low=-90.0, high=90.0,
              sensor=BAHRS, needs={'publish.derived_magnetic_field': (True,)}),
    Parameter('publish.derived_magnetic_field', True,
              'Whether to publish imu/mag for a device that reports a heading but no field.',
              sensor=BAHRS),
    Parameter('publish.incomplete', 'nan',
              'What becomes of a message in which a component is not available: nan publishes it '
              'with NaN in its place, withhold does not publish it, for filters that never '
              'recover from a NaN. NavSatFix messages are published in any case.',
              choices=('nan', 'withhold')),
    Parameter('publish.raw', False,
              'Whether to publish raw, the bytes of each read as they came. A bag that holds it '
              'holds everything, and can be converted again.'),
    Parameter('startup.wait_for_subscribers', 0.0,
              'Longest time to wait, before the port is opened, until each data topic has a '
              'subscriber, so that a recorder that was started first misses nothing; 0 does not '
              'wait.', 's', low=0.0, high=60.0),
    Parameter('state.rate', 50.0,
              'How often to ask a titan_m for its state: attitude, velocity, position; 0 is '
              'never.', 'Hz', low=0.01, high=1000.0, or_zero=True, sensor=TITAN_M),
    Parameter('sensors.rate', 50.0,
              'How often to ask a titan_m for what its sensors measure; 0 is never.', 'Hz',
              low=0.01, high=1000.0, or_zero=True, sensor=TITAN_M),
    Parameter('gps.rate', 10.0, 'How often to ask a titan_m for its GPS position; 0 is never.',
              'Hz', low=0.01, high=1000.0, or_zero=True, sensor=TITAN_M),
    Parameter('gps.week', 0,
              'GPS week since 1980 in which the driver is started, for a host whose clock is not '
              'set; 0 is unknown. If the clock is set, the week nearest to it is used, and a '
              'gps.week that contradicts it is reported.', low=0, high=3000, sensor=TITAN_M),
    Parameter('gps.leap_seconds', 18, 'GPS time less UTC, for time_reference.', 's',
              low=0, high=100, sensor=TITAN_M),
    Parameter('gps.geoid_height', 0.0,
              'Added to the altitude of fix: height of the geoid above the ellipsoid, if the '
              'device gives altitudes above mean sea level, which its document does not say.', 'm',
              low=-200.0, high=200.0, sensor=TITAN_M),
    Parameter('request.pipelined', False,
              'Whether one request of each kind may be under way at once, rather than one at all: '
              'for adapters that hold bytes back, if the device can take it.', sensor=TITAN_M),
    Parameter('request.timeout', 0.2,
              'How long to wait for an answer at most. Less, once it is known how long answers '
              'take.', 's', low=0.01, high=5.0, sensor=TITAN_M),
    Parameter('request.retries', 1, 'How often to repeat a request that is not answered.',
              low=0, high=10, sensor=TITAN_M),
    Parameter('request.message_id', 'zero',
              'Message id of requests: zero, byte for byte as in the protocol document, or '
              'counted, which lets late answers be told if the device sends ids back.',
              choices=('zero', 'counted'), sensor=TITAN_M),
    Parameter('payload_order', 'auto',
              'Byte order of what a titan_m answers: auto tells by what its values can be, and '
              'holds answers until it knows.', choices=('auto', 'little', 'big'), sensor=TITAN_M),
    Parameter('checksum_order', 'auto',
              'Byte order of the checksums of a titan_m: auto takes either in answers, and in '
              'requests tries big, as printed in the protocol document, then little.',
              choices=('auto', 'little', 'big'), sensor=TITAN_M),
    Parameter('integrity.risk_policy', 'inflate',
              'What becomes of a signal at integrity risk: inflate publishes it with a larger '
              'variance, withhold treats it as unavailable, pass publishes it as it is.',
              choices=('inflate', 'withhold', 'pass'), sensor=BAHRS),
    Parameter('integrity.risk_inflation', 100.0,
              'Factor on the variance of a signal at integrity risk, for the policy inflate.',
              low=1.0, high=1e6, sensor=BAHRS, needs={'integrity.risk_policy': ('inflate',)}),
    Parameter('diagnostics.silence_timeout', 1.0,
              'Time without a byte, or without a data message, from which on the device is '
              'reported as silent.', 's', low=0.1, high=60.0),
    Parameter('diagnostics.rate_tolerance', 0.05,
              'Share by which the rate of a message may differ from what is expected without a '
              'warning.', low=0.0, high=1.0),
    Parameter('diagnostics.damaged_share', 0.1,
              'Share of damaged frames above which the line is reported as unusable; below, any '
              'damaged frame is a warning.', low=0.0, high=1.0),
    Parameter('diagnostics.qualified_name', False,
              'Whether names in /diagnostics begin with the fully qualified name of the node '
              '(/bahrs_driver: Link) at the root, too. In a namespace they always do '
              '(/left/bahrs_driver: Link).'),
    Parameter('time.source', 'device',
              'What stamps are made of: device puts device time on ROS time from when samples '
              'arrive (a titan_m has none: the middle of request and answer), sync_pulse does so '
              'with the help of sync pulses, arrival is the time of arrival, for comparison.',
              choices=('device', 'sync_pulse', 'arrival')),
    Parameter('time.label', 'auto',
              'Which sample a time message names: next is the one after the sample that it is '
              'about, as devices do, same is that sample, as the protocol document says.',
              choices=('auto', 'next', 'same'),
              sensor=BAHRS, needs={'time.source': ('device', 'sync_pulse')}),
    Parameter('time.fixed_latency', 0.0,
              'Subtracted from every stamp: the least delay from a sample to its first byte, '
              'which cannot be observed without sync pulses.', 's', low=0.0, high=1.0),
    Parameter('time.sync_pulse.period', 1.0, 'Time from one sync pulse to the next.', 's',
              low=0.1, high=60.0, sensor=BAHRS, needs={'time.source': ('sync_pulse',)}),
    Parameter('time.sync_pulse.reference', 'ros_clock',
              'Where the time of a sync pulse is known from: ros_clock takes the nearest whole '
              'period of ROS time, for a host that is disciplined by the same receiver; anything '
              'else is the name of a sensor_msgs/TimeReference topic whose header has it.',
              sensor=BAHRS, needs={'time.source': ('sync_pulse',)}),
    Parameter('pressure_height.format', 'uint16',
              'How the pressure height stands on the wire. Devices send uint16; int16 is what '
              'the protocol document says.', choices=('uint16', 'int16'), sensor=BAHRS),
    Parameter('crc_order', 'auto',
              'Order in which the CRC of a frame takes its bytes: 32-bit words, as devices do, '
              'or single bytes, as the protocol document says.',
              choices=('auto', 'word', 'byte'), sensor=BAHRS),
    Parameter('nvm.page', 0, 'Page that the service ~/nvm/read_page reads.', low=0, high=249,
              read_only=False, sensor=BAHRS),
    Parameter('nvm.directory', '~/bahrs_nvm',
              'Directory that the service ~/nvm/dump may write into; made when missing.',
              sensor=BAHRS),
    Parameter('nvm.dump_path', 'bahrs_nvm.bin',
              'File that the service ~/nvm/dump writes or replaces: relative to nvm.directory, or '
              'absolute inside it.', read_only=False, sensor=BAHRS),
    Parameter('nvm.enter_timeout', 30.0,
              'How long to ask the device to enter diagnostics mode. Many do so only within 0.5 s '
              'of power-on: call the service, then switch the device off and on.', 's',
              low=1.0, high=600.0, read_only=False, sensor=BAHRS),
    Parameter('nvm.service_frames', 'auto',
              'Checksum and padding of what is sent to the device: auto tries all, those of the '
              "maker's tool (crc32) first, then those of the document (mpeg2_padded).",
              choices=('auto', 'crc32', 'mpeg2', 'crc32_padded', 'mpeg2_padded'),
              read_only=False, sensor=BAHRS),
)

BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}


def defaults() -> dict[str, Any]:
    """Return the default of every parameter."""
    return {parameter.name: parameter.default for parameter in PARAMETERS}

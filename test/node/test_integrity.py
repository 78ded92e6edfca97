# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test that subscribers receive the integrity that the device sent with each sample."""

from bisect import bisect_right
import math
import random

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.protocol.bahrs.messages import (
    ANGLE, FORCE, HEIGHT, Inertial, Navigation, VELOCITY)
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from support.devices import DEEP, Device, DIAGNOSTICS, SAFE, says
from support.processes import driver, listening, wait_for

SIGNALS = Inertial.SIGNALS + Navigation.SIGNALS
FACTOR = {Integrity.SAFE: 1, Integrity.INTEGRITY_RISK: 100}       # of the variance
STATES = {2: [Integrity.UNAVAILABLE, Integrity.SAFE], 3: list(Integrity)}


def nanoseconds(message):
    """Return the stamp of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


class Scenario:
    """Switches each signal through each state, then all at random, then back to safe."""

    def __init__(self, version):
        """Write the scenario down, a row for every nine inertial samples."""
        chance, self._rows = random.Random(11), [[Integrity.SAFE] * 11]
        for signal in range(11):
            for state in [*STATES[version], Integrity.SAFE]:
                self._rows.append([*self._rows[-1]])
                self._rows[-1][signal] = state
        self._rows += [[chance.choice(STATES[version]) for _ in range(11)] for _ in range(20)]
        self.begin = None           # number of its first sample; all are safe before it
        self._wanted = False

    def start(self):
        """Begin with the next sample."""
        self._wanted = True

    def __call__(self, index):
        """Return the health of inertial and navigation message number so-and-so."""
        if self._wanted and self.begin is None:
            self.begin = index
        row = -1 if self.begin is None else (index - self.begin) // 9
        now = self._rows[row] if 0 <= row < len(self._rows) else self._rows[0]
        return tuple(now[:6]), tuple(now[6:])

    @property
    def end(self):
        """Return the number of the first sample after it."""
        return self.begin + 9 * len(self._rows)


class Notices:
    """The notices on the topic `integrity`, by time."""

    def __init__(self, messages):
        """Store all notices."""
        self._times = [nanoseconds(message) for message in messages]
        self._states = [{status.name: status.message for status in message.status}
                        for message in messages]

    def at(self, time):
        """Return the state of all signals that held at a stamp."""
        return self._states[bisect_right(self._times, time) - 1]

    def __len__(self):
        """Return their number."""
        return len(self._times)


@pytest.mark.parametrize('version', [2, 3])
def test_every_sample_says_what_the_device_said_of_it(cable, version):
    """Each signal through each state: values, covariances, and the notice for its stamp."""
    scenario = Scenario(version)
    device = Device(cable, version, scenario)
    with listening(TOPICS) as ear, driver(cable.path, **DEEP), device:
        for topic in TOPICS:
            ear.wait(topic)
        scenario.start()
        assert wait_for(lambda: scenario.begin and len(device.inertial) > scenario.end + 20)
        assert wait_for(lambda: came(ear.messages['imu/data_raw'][-1], scenario.end + 10))
    notices = Notices(ear.messages['integrity'])
    assert len(notices) >= 40
    check_inertial(ear.messages, notices, device.inertial)
    check_navigation(ear.messages, notices, device.navigation)
    check_attitude(ear.messages, notices, device.inertial, device.navigation)


def came(imu, index):
    """Return whether this is the message with this number, or a later one."""
    return not math.isnan(imu.linear_acceleration.x) and number(imu) >= index


def number(imu):
    """Return which message of the device this is."""
    return round(imu.linear_acceleration.x / FORCE)


def sources(received, first, sent, published):
    """Return pairs of a message on a topic, from the first one on, and its source."""
    sent = sent[first:]
    pairs = list(zip(received, [message for message in sent if published(message)]))
    assert len(pairs) > 0.3 * len(sent)
    return pairs


def check_inertial(received, notices, sent):
    """Check that exactly the available components are published, with their variances."""
    messages = received['imu/data_raw']
    for imu, message in sources(messages, number(messages[0]), sent, lambda m: True):
        notice = notices.at(nanoseconds(imu))
        assert [notice[name] for name in Inertial.SIGNALS] == [s.label for s in message.health]
        force, rate = imu.linear_acceleration, imu.angular_velocity
        values = (force.x, force.y, force.z, rate.x, rate.y, rate.z)
        assert [math.isnan(value) for value in values] == [
            not state.available for state in message.health]
        check_variances(imu.linear_acceleration_covariance, message.health[:3], 1e-4)
        check_variances(imu.angular_velocity_covariance, message.health[3:], 2.5e-7)


def check_variances(matrix, health, variance):
    """Check that only safe components have the variance of a safe one."""
    if not any(state.available for state in health):
        assert matrix[0] == -1
        return
    factors = {Integrity.SAFE: variance, Integrity.INTEGRITY_RISK: 100 * variance}
    assert matrix[[0, 4, 8]] == pytest.approx([factors.get(state, 1e6) for state in health])


def check_navigation(received, notices, sent):
    """Check that topics are published exactly when their signal is available."""
    poses, twists, headings = received['altitude/pose'], received['velocity'], received['heading']
    first = round(poses[0].pose.pose.position.z / HEIGHT)
    for pose, message in sources(poses, first, sent, lambda m: m.health[0].available):
        assert pose.pose.pose.position.z == pytest.approx(message.pressure_height, abs=0.1)
        check_notice(notices.at(nanoseconds(pose)), message)
        assert pose.pose.covariance[14] == (1 if message.health[0] is Integrity.SAFE else 100)
    stamps = [nanoseconds(pose) for pose in poses]
    for topic in ('static_pressure', 'pressure_altitude'):
        same = [nanoseconds(message) for message in received[topic]]
        begin = max(stamps[0], same[0])
        assert all(a == b for a, b in zip(stamps[stamps.index(begin):], same[same.index(begin):]))
    first = round(-twists[0].twist.twist.linear.z / VELOCITY)
    for twist, message in sources(twists, first, sent, lambda m: m.health[1].available):
        assert -twist.twist.twist.linear.z == pytest.approx(message.velocity_down, abs=0.01)
        check_notice(notices.at(nanoseconds(twist)), message)
        assert twist.twist.covariance[14] == pytest.approx(
            0.04 if message.health[1] is Integrity.SAFE else 4)
    first = round(math.radians(headings[0].data) / ANGLE)
    for heading, message in sources(headings, first, sent, lambda m: True):
        assert math.isnan(heading.data) == (not message.health[4].available)


def check_attitude(received, notices, inertial, navigation):
    """Check that the covariance of the orientation follows roll, pitch and heading."""
    imus = received['imu/data']
    # The first message may be a navigation message without its inertial sample.
    while math.isnan(imus[0].linear_acceleration.x):
        imus = imus[1:]
    begin = number(imus[0]) // 2
    published = [message for turn, message in enumerate(navigation)
                 if turn >= begin and 2 * turn < len(inertial)]
    complete = []               # stamps of those from which a field can be derived
    # The first may have come before the first accuracy message.
    for imu, message in list(zip(imus, published))[20:]:
        check_notice(notices.at(nanoseconds(imu)), message)
        if not tilt_factor(message):
            assert imu.orientation_covariance[0] == -1
            continue
        heading = message.health[4]
        east, north, up = imu.orientation_covariance[[0, 4, 8]]
        # Without a heading the larger of the two counts for both.
        tilts = (4e-4, 1e-4) if heading.available else (4e-4, 4e-4)
        assert (east, north) == pytest.approx(
            tuple(tilt * tilt_factor(message) for tilt in tilts), rel=0.02)
        assert up == pytest.approx(9e-4 * FACTOR[heading] if heading.available else 1e6, rel=0.02)
        if heading.available:
            complete.append(nanoseconds(imu))
    fields = [nanoseconds(field) for field in received['imu/mag']]
    assert len(complete) > 100
    begin = max(complete[0], fields[0])     # whichever topic was found later
    assert all(a == b for a, b in zip(complete[complete.index(begin):],
                                      fields[fields.index(begin):]))


def tilt_factor(message):
    """Return the larger variance factor of roll and pitch; 0 if either is unavailable."""
    roll, pitch = message.health[2:4]
    return max(FACTOR[roll], FACTOR[pitch]) if roll.available and pitch.available else 0


def check_notice(notice, message):
    """Check that the notice for a sample has the integrity that the device sent with it."""
    assert [notice[name] for name in Navigation.SIGNALS] == [s.label for s in message.health]


def test_a_late_joiner_gets_the_present_state(cable):
    """With the first message."""
    def health(index):
        return (SAFE, (Integrity.SAFE,) * 4 + (Integrity.UNAVAILABLE,))

    with listening(TOPICS) as ear, driver(cable.path), Device(cable, health=health):
        ear.wait('imu/data', 50)
        late = []
        ear.node.create_subscription(
            DiagnosticArray, 'integrity', late.append,
            QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))

        assert wait_for(lambda: late)
        state = {item.name: item.message for item in late[0].status}
        assert state['magnetic_heading'] == 'unavailable' and state['roll'] == 'safe'


def test_a_level_change_is_in_diagnostics_within_a_tenth_of_a_second(cable):
    """
    Counted from the stamp of the sample that caused it, six times in a row.

    A machine that does much else may be late now and then; reports at 1 Hz never manage six.
    """
    def health(index):
        heading = Integrity.SAFE if index // 60 % 2 == 0 else Integrity.INTEGRITY_RISK
        return (SAFE, (Integrity.SAFE,) * 4 + (heading,))

    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(cable.path), \
            Device(cable, health=health):
        # The notices are latched: those from before the first report prove nothing.
        ear.wait('/diagnostics')
        begin = len(ear.messages['integrity']) + 1

        def six_in_a_row():
            prompt = ''.join('y' if delay(ear, change) < 100_000_000 else 'n'
                             for change in ear.messages['integrity'][begin:][-8:])
            return 'y' * 6 in prompt

        assert wait_for(six_in_a_row)
        assert says(ear, 'Integrity', DiagnosticStatus.WARN, 'magnetic_heading integrity risk')


def delay(ear, change):
    """Return the nanoseconds from a change to the first report of its level."""
    level = max((item.level for item in change.status), key=ord)
    return min((nanoseconds(array) - nanoseconds(change)
                for array in ear.messages['/diagnostics'][-200:]
                for item in array.status
                if item.name == 'bahrs_driver: Integrity' and item.level == level
                and nanoseconds(array) >= nanoseconds(change)), default=math.inf)


def test_a_silent_device_leaves_no_signal_safe(cable):
    """A late subscriber receives no old state, and each sample keeps its integrity."""
    def known():
        notices = ear.messages['integrity']
        return notices and {item.message for item in notices[-1].status}

    with listening(TOPICS) as ear, driver(cable.path):
        for _ in range(2):
            with Device(cable):
                assert wait_for(lambda: known() == {'safe'})
                ear.wait('imu/data_raw', len(ear.messages['imu/data_raw']) + 20)
            assert wait_for(lambda: known() == {'not_heard'})
        notices = Notices(ear.messages['integrity'])
        assert all(notices.at(nanoseconds(imu))['angular_rate_x'] == 'safe'
                   for imu in ear.messages['imu/data_raw'][1:])


def test_a_lost_cable_leaves_no_signal_safe(tmp_path):
    """The notice and the diagnostics report it."""
    topics = {**TOPICS, **DIAGNOSTICS}
    # By a link, for the number of a pseudo-terminal that is gone is given to the next that asks.
    link = str(tmp_path / 'port')
    with listening(topics) as ear, driver(link):
        with PtyPort(link) as cable, Device(cable):
            ear.wait('imu/data', 20)
            assert says(ear, 'Integrity', DiagnosticStatus.OK, 'All signals safe')
        assert wait_for(lambda: ear.messages['integrity'] and {
            item.message for item in ear.messages['integrity'][-1].status} == {'not_heard'})
        assert says(ear, 'Integrity', DiagnosticStatus.STALE, 'No data')
        assert says(ear, 'Link', DiagnosticStatus.ERROR, '')

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the BAHRS messages: their layouts and scales in each version."""

from dataclasses import fields
import math
import struct

from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    Acknowledgement,
    HardwareVersion,
    Inertial,
    InertialTime,
    layouts,
    MESSAGES,
    Navigation,
    NavigationTime,
    NvmPage,
    NvmReadRequest,
    SoftwareVersion,
    SyncPulseTime,
    VERSIONS,
)
from bahrs_driver.protocol.integrity import Integrity
from hypothesis import given, strategies as st
import pytest
from support import independent

SAFE, UNAVAILABLE = Integrity.SAFE, Integrity.UNAVAILABLE
RISK, RESERVED = Integrity.INTEGRITY_RISK, Integrity.RESERVED
ALL_SAFE = (SAFE,) * 6

LAYOUTS = layouts()
SIZES = independent.STREAM_PAYLOADS | independent.SERVICE_PAYLOADS

# The scales of the documents.
FORCE_RATE_2 = [1.495384e-3] * 3 + [1.597921e-4] * 3
FORCE_RATE_3 = [1.4964e-3] * 3 + [1.5979452e-4] * 3
HEIGHT, VELOCITY, ANGLE = 0.16784924, 9.155413e-3, 9.587526e-5
NAVIGATION = [HEIGHT, VELOCITY, ANGLE, ANGLE, ANGLE]


def numbers(message):
    """Return the values of a message as one flat list."""
    values = (getattr(message, item.name) for item in fields(message))
    return [number for value in values
            for number in (value if isinstance(value, tuple) else [value])]


def decode(version, message_type, payload, height_format='uint16'):
    """Decode a payload."""
    return layouts(height_format)[version, message_type].decode(payload)


def test_every_message_has_its_payload_size():
    """No version has more messages than it should."""
    assert {key: layout.size for key, layout in LAYOUTS.items()} == SIZES


def test_versions_1_to_3_are_known():
    """They are those of section 6."""
    assert tuple(VERSIONS) == (1, 2, 3)


def test_messages_have_the_documented_names():
    """By type, as in the shared vectors."""
    assert {message.TYPE: message.NAME for message in MESSAGES} == {
        0x01: 'inertial', 0x02: 'navigation', 0x03: 'accuracy', 0x04: 'navigation_time',
        0x05: 'inertial_time', 0x06: 'sync_pulse_time', 0x0F: 'software_version',
        0x1F: 'hardware_version', 0xF0: 'enter_diagnostics', 0xF1: 'exit_diagnostics',
        0xF2: 'nvm_read_request', 0xF3: 'nvm_page', 0xFF: 'acknowledgement'}


def test_service_messages_are_those_from_0xf0():
    """Section 5."""
    assert {m.TYPE for m in MESSAGES if m.SERVICE} == {0xF0, 0xF1, 0xF2, 0xF3, 0xFF}


def test_signals_are_named_in_the_order_of_the_health_bits():
    """Sections 3.1 and 3.2."""
    assert Inertial.SIGNALS == (
        'specific_force_x', 'specific_force_y', 'specific_force_z',
        'angular_rate_x', 'angular_rate_y', 'angular_rate_z')
    assert Navigation.SIGNALS == (
        'pressure_height', 'velocity_down', 'roll', 'pitch', 'magnetic_heading')


@independent.properties(60)
@given(st.sampled_from((1, 2)), st.binary(min_size=14, max_size=14))
def test_inertial_of_versions_1_and_2(version, payload):
    """With the scales of the recorded device and one valid bit per signal."""
    sequence, *raw, health = struct.unpack('<B6hB', payload)
    values = numbers(decode(version, 0x01, payload))
    assert values[0] == sequence
    assert values[1:7] == pytest.approx([n * s for n, s in zip(raw, FORCE_RATE_2)], rel=1e-12)
    assert values[7:] == [health >> i & 1 for i in range(6)]


@independent.properties(60)
@given(st.binary(min_size=15, max_size=15))
def test_inertial_of_version_3(payload):
    """With the scales of the document and two bits per signal."""
    sequence, *raw, health = struct.unpack('<B6hH', payload)
    values = numbers(decode(3, 0x01, payload))
    assert values[0] == sequence
    assert values[1:7] == pytest.approx([n * s for n, s in zip(raw, FORCE_RATE_3)], rel=1e-12)
    assert values[7:] == [health >> 2 * i & 3 for i in range(6)]


@independent.properties(60)
@given(st.sampled_from(((1, '<BHhhhhB', 1), (2, '<BHhhhHB', 1), (3, '<BHhhhHH', 2))),
       st.binary(min_size=13, max_size=13))
def test_navigation(case, payload):
    """Heading is signed in version 1 only; height is unsigned."""
    version, code, bits = case
    sequence, *raw, health = struct.unpack_from(code, payload)
    raw[0] -= 1000 / HEIGHT
    values = numbers(decode(version, 0x02, payload))
    assert values[0] == sequence
    assert values[1:6] == pytest.approx([n * s for n, s in zip(raw, NAVIGATION)], abs=1e-9)
    assert values[6:] == [health >> bits * i & 2 ** bits - 1 for i in range(5)]


@independent.properties(60)
@given(st.sampled_from((1, 2, 3)), st.binary(min_size=15, max_size=15))
def test_accuracy(version, payload):
    """Deviations are unsigned."""
    sequence, *raw, time = struct.unpack('<BHHHQ', payload)
    message = decode(version, 0x03, payload)
    assert (message.sequence, message.device_time_us) == (sequence, time)
    assert [message.north_std, message.east_std, message.heading_std] == \
        [pytest.approx(n * ANGLE, rel=1e-12) if n else None for n in raw]


@pytest.mark.parametrize('zero', [0, 1, 2])
def test_each_deviation_of_zero_is_none(zero):
    """Independently of the other two."""
    raw = [10, 10, 10]
    raw[zero] = 0
    message = decode(3, 0x03, struct.pack('<BHHHQ', 0, *raw, 0))
    values = [message.north_std, message.east_std, message.heading_std]
    assert [value is None for value in values] == [i == zero for i in range(3)]


@pytest.mark.parametrize('version', [1, 2, 3])
@pytest.mark.parametrize('message_type, kind', [(0x04, NavigationTime), (0x05, InertialTime)])
def test_time_messages(version, message_type, kind):
    """Device time has 64 bits."""
    payload = bytes.fromhex('09c8' 'ffeeddccbbaa9988')
    assert decode(version, message_type, payload) == kind(9, 200, 0x8899AABBCCDDEEFF)


@pytest.mark.parametrize('reference, time, valid', [
    (0, 0, False), (1, 0, True), (0, 1, True), (255, 2 ** 64 - 1, True)])
@pytest.mark.parametrize('kind', [NavigationTime, InertialTime])
def test_a_time_message_is_invalid_when_both_fields_are_zero(kind, reference, time, valid):
    """As in sections 3.4 and 3.5; its own sequence number does not matter."""
    assert kind(5, reference, time).valid is valid


def test_the_two_time_messages_are_never_equal():
    """They have the same fields, but different meanings."""
    assert NavigationTime(1, 2, 3) != InertialTime(1, 2, 3)


@pytest.mark.parametrize('version, message_type, payload, message', [
    (2, 0x06, '09' '15cd5b0700000000', SyncPulseTime(9, 123456789)),
    (2, 0x0F, '4f5353' '0200' '1101', SoftwareVersion('OSS', 2, 273)),
    (3, 0x0F, '504600' 'ffff' '0000', SoftwareVersion('PF', 65535, 0)),
    (3, 0x1F, '1304' '01000000' 'efcdab89' 'ffffffff',
     HardwareVersion(0x413, (1, 0x89ABCDEF, 0xFFFFFFFF))),
    (3, 0xF2, 'd4', NvmReadRequest(212)),
    (1, 0xF3, '02' + bytes(range(32)).hex(), NvmPage(2, bytes(range(32)))),
    (3, 0xFF, 'f2ff', Acknowledgement(0xF2, 0xFF)),
])
def test_other_messages(version, message_type, payload, message):
    """In both directions."""
    layout = LAYOUTS[version, message_type]
    assert layout.decode(bytes.fromhex(payload)) == message
    assert layout.encode(message).hex() == payload


@pytest.mark.parametrize('version', [1, 2, 3])
def test_a_height_above_4500_m_is_decoded_as_unsigned_by_default(version):
    """0x9000 is 5,187.6 m, not -5,812.6 m."""
    payload = bytes.fromhex('00' '0090') + bytes(10)
    assert decode(version, 0x02, payload).pressure_height == pytest.approx(5187.59438336)


@pytest.mark.parametrize('version', [1, 2, 3])
def test_a_height_above_4500_m_is_decoded_as_signed_on_request(version):
    """As in the table of the document."""
    payload = bytes.fromhex('00' '0090') + bytes(10)
    height = decode(version, 0x02, payload, 'int16').pressure_height
    assert height == pytest.approx(-5812.57340928)


@pytest.mark.parametrize('version', [1, 2, 3])
def test_a_height_below_4500_m_is_equal_in_both_formats(version):
    """0x2400 is 546.9 m."""
    payload = bytes.fromhex('00' '0024') + bytes(10)
    assert [decode(version, 0x02, payload, height_format).pressure_height
            for height_format in ('uint16', 'int16')] == [pytest.approx(546.89859584)] * 2


@pytest.mark.parametrize('height_format, height, raw', [
    ('uint16', 5187.6, 0x9000), ('uint16', 9999.95, 0xFFFF), ('uint16', -1000.0, 0),
    ('int16', 4499.9, 0x7FFF), ('int16', -5812.6, 0x9000), ('int16', -6499.9, 0x8001)])
def test_a_height_is_encoded_in_its_format(height_format, height, raw):
    """Below -1000 m only as int16, above 4,500 m only as uint16."""
    message = Navigation(0, height, 0.0, 0.0, 0.0, 0.0, ALL_SAFE[:5])
    payload = layouts(height_format)[3, 0x02].encode(message)
    assert int.from_bytes(payload[1:3], 'little') == raw


@pytest.mark.parametrize('version, heading, raw', [
    (1, -math.pi, -32768), (1, 3.1415, 32767), (2, 2 * math.pi, 65535), (3, 3.2, 33377)])
def test_a_heading_is_encoded_in_its_range(version, heading, raw):
    """-pi to pi in version 1, 0 to 2 pi from version 2 on."""
    message = Navigation(0, 0.0, 0.0, 0.0, 0.0, heading, ALL_SAFE[:5])
    payload = LAYOUTS[version, 0x02].encode(message)
    assert int.from_bytes(payload[9:11], 'little', signed=version == 1) == raw


def signed(scale):
    """Return a strategy of values that fit an int16."""
    return st.floats(-32768.49 * scale, 32767.49 * scale)


def unsigned(scale):
    """Return a strategy of values that fit an uint16."""
    return st.floats(-0.49 * scale, 65535.49 * scale)


def health(count, version):
    """Return a strategy of health values that the version can encode."""
    values = (UNAVAILABLE, SAFE) if version < 3 else (UNAVAILABLE, SAFE, RISK, RESERVED)
    return st.tuples(*[st.sampled_from(values)] * count)


BYTE, TIME = st.integers(0, 255), st.integers(0, 2 ** 64 - 1)


@independent.properties(150)
@given(st.sampled_from((1, 2, 3)), st.data())
def test_inertial_is_decoded_to_within_half_a_quantum(version, data):
    """For any values in range."""
    scales = FORCE_RATE_3 if version == 3 else FORCE_RATE_2
    values = data.draw(st.tuples(*map(signed, scales)))
    message = Inertial(data.draw(BYTE), values[:3], values[3:], data.draw(health(6, version)))
    layout = LAYOUTS[version, 0x01]
    back = layout.decode(layout.encode(message))
    assert (back.sequence, back.health) == (message.sequence, message.health)
    for sent, came, scale in zip(values, back.specific_force + back.angular_rate, scales):
        assert abs(came - sent) <= 0.500001 * scale


@independent.properties(150)
@given(st.sampled_from((1, 2, 3)), st.sampled_from(('uint16', 'int16')), st.data())
def test_navigation_is_decoded_to_within_half_a_quantum(version, height_format, data):
    """For any values in range, in both height formats."""
    height = data.draw((unsigned if height_format == 'uint16' else signed)(HEIGHT)) - 1000
    others = data.draw(st.tuples(signed(VELOCITY), signed(ANGLE), signed(ANGLE),
                                 (signed if version == 1 else unsigned)(ANGLE)))
    message = Navigation(data.draw(BYTE), height, *others, data.draw(health(5, version)))
    layout = layouts(height_format)[version, 0x02]
    back = layout.decode(layout.encode(message))
    assert (back.sequence, back.health) == (message.sequence, message.health)
    for sent, came, scale in zip((height, *others), numbers(back)[1:6], NAVIGATION):
        assert abs(came - sent) <= 0.500001 * scale


@independent.properties(150)
@given(st.sampled_from((1, 2, 3)), BYTE, TIME,
       st.tuples(*[st.none() | st.floats(0.51 * ANGLE, 65535.49 * ANGLE)] * 3))
def test_accuracy_is_decoded_to_within_half_a_quantum(version, sequence, time, deviations):
    """None is decoded as None."""
    layout = LAYOUTS[version, 0x03]
    back = layout.decode(layout.encode(Accuracy(sequence, *deviations, time)))
    assert (back.sequence, back.device_time_us) == (sequence, time)
    for sent, came in zip(deviations, (back.north_std, back.east_std, back.heading_std)):
        assert came is None if sent is None else abs(came - sent) <= 0.500001 * ANGLE


ZERO = (0.0, 0.0, 0.0)
HEALTH = ALL_SAFE[:5]


@pytest.mark.parametrize('version, message, name', [
    (3, Inertial(256, ZERO, ZERO, ALL_SAFE), 'sequence'),
    (3, Inertial(-1, ZERO, ZERO, ALL_SAFE), 'sequence'),
    (3, Inertial(0, (49.04, 0.0, 0.0), ZERO, ALL_SAFE), 'specific_force'),
    (2, Inertial(0, (0.0, 0.0, -49.01), ZERO, ALL_SAFE), 'specific_force'),
    (2, Inertial(0, (math.nan, 0.0, 0.0), ZERO, ALL_SAFE), 'specific_force'),
    (1, Inertial(0, ZERO, (0.0, 5.24, 0.0), ALL_SAFE), 'angular_rate'),
    (3, Inertial(0, ZERO, (0.0, -5.24, 0.0), ALL_SAFE), 'angular_rate'),
    (3, Navigation(0, -1000.1, 0.0, 0.0, 0.0, 0.0, HEALTH), 'pressure_height'),
    (3, Navigation(0, 10000.1, 0.0, 0.0, 0.0, 0.0, HEALTH), 'pressure_height'),
    (3, Navigation(0, 0.0, 300.1, 0.0, 0.0, 0.0, HEALTH), 'velocity_down'),
    (3, Navigation(0, 0.0, -math.inf, 0.0, 0.0, 0.0, HEALTH), 'velocity_down'),
    (3, Navigation(0, 0.0, 0.0, 3.15, 0.0, 0.0, HEALTH), 'roll'),
    (3, Navigation(0, 0.0, 0.0, 0.0, -3.15, 0.0, HEALTH), 'pitch'),
    (1, Navigation(0, 0.0, 0.0, 0.0, 0.0, 3.2, HEALTH), 'magnetic_heading'),
    (2, Navigation(0, 0.0, 0.0, 0.0, 0.0, -0.1, HEALTH), 'magnetic_heading'),
    (3, Navigation(0, 0.0, 0.0, 0.0, 0.0, 6.2833, HEALTH), 'magnetic_heading'),
    (3, Accuracy(0, -0.1, None, None, 0), 'north_std'),
    (3, Accuracy(0, None, 6.3, None, 0), 'east_std'),
    (3, Accuracy(0, None, None, math.nan, 0), 'heading_std'),
    (3, Accuracy(0, None, None, None, 2 ** 64), 'device_time_us'),
    (3, NavigationTime(0, 256, 0), 'reference_sequence'),
    (3, InertialTime(0, 0, -1), 'device_time_us'),
    (3, SyncPulseTime(0, 2 ** 64), 'device_time_us'),
    (3, SoftwareVersion('LONG', 0, 0), 'project'),
    (3, SoftwareVersion('OSS', 65536, 0), 'major'),
    (3, SoftwareVersion('OSS', 0, -1), 'minor'),
    (3, HardwareVersion(65536, (0, 0, 0)), 'mcu_id'),
    (3, HardwareVersion(0, (0, 0, 2 ** 32)), 'unique_id'),
    (3, HardwareVersion(0, (0, 0)), 'unique_id'),
    (3, NvmReadRequest(256), 'page'),
    (3, NvmPage(0, bytes(31)), 'data'),
    (3, Acknowledgement(0xF2, -1), 'status'),
])
def test_the_error_of_a_value_out_of_range_names_its_field(version, message, name):
    """Values do not wrap around."""
    with pytest.raises(ValueError, match=f'^{name}: '):
        LAYOUTS[version, message.TYPE].encode(message)


def test_a_height_above_4500_m_does_not_fit_an_int16():
    """It would be decoded as below ground."""
    with pytest.raises(ValueError, match='^pressure_height: '):
        layouts('int16')[2, 0x02].encode(Navigation(0, 5000.0, 0.0, 0.0, 0.0, 0.0, HEALTH))


@independent.properties(300)
@given(st.sampled_from(sorted(SIZES.items())), st.data())
def test_any_payload_encodes_back_to_itself(case, data):
    """Except for the reserved bits of health, which are cleared."""
    (version, message_type), size = case
    payload = bytearray(data.draw(st.binary(min_size=size, max_size=size)))
    if message_type in (0x01, 0x02):
        signals = 6 if message_type == 0x01 else 5
        payload[-1] &= 2 ** signals - 1 if version < 3 else 2 ** (2 * signals - 8) - 1
    layout = LAYOUTS[version, message_type]
    assert layout.encode(layout.decode(bytes(payload))) == payload

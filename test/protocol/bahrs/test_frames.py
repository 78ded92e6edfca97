# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of BAHRS frames: sizes, checksums, both directions, the independent vectors."""

from dataclasses import asdict

from bahrs_driver.protocol.bahrs.frames import (
    BahrsCodec,
    BahrsFormat,
    build_frame,
    frame_size,
    frame_version,
)
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    Acknowledgement,
    EnterDiagnostics,
    ExitDiagnostics,
    HardwareVersion,
    Inertial,
    MESSAGES,
    Navigation,
    NavigationTime,
    NvmPage,
    NvmReadRequest,
    SoftwareVersion,
    SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.integrity import Integrity
from hypothesis import given, strategies as st
import pytest
from support import independent

SAFE, UNAVAILABLE, RISK = Integrity.SAFE, Integrity.UNAVAILABLE, Integrity.INTEGRITY_RISK
FIRST_FRAME = bytes.fromhex('4e45020001 00 d5ffe2ff8ae6 fcff02000700 3f 00 f65b0c0a')

NAVIGATION = {'sequence': 7, 'pressure_height': 5187.59438336, 'velocity_down': -0.9155413,
              'roll': 0.4793763, 'pitch': -0.4793763}
SMALL_RATE = (0.0001597921, -0.0001597921, 0.0)
VALID_1, VALID_2 = (SAFE, UNAVAILABLE, SAFE, UNAVAILABLE, UNAVAILABLE, SAFE), \
    (SAFE, UNAVAILABLE, UNAVAILABLE, SAFE, SAFE)
PAGE = bytes(range(32))

# (frame, checksum, message), with frames made from the document, except the first, which
# the device sent.
STREAM = [
    (FIRST_FRAME.hex(), 'word', Inertial(
        0, (-0.064301512, -0.04486152, -9.746912912), (-0.0006391684, 0.0003195842, 0.0011185447),
        (SAFE,) * 6)),
    ('4e45010001ffff7f00808ae60100ffff00002500bb0c7dd1', 'word', Inertial(
        255, (48.999247528, -49.000742912, -9.746912912), SMALL_RATE, VALID_1)),
    ('4e450100020700909cff881378ecd08a190000005de77902', 'word', Navigation(
        **NAVIGATION, magnetic_heading=-2.8762578, health=VALID_2)),
    ('4e450100020700909cff881378ecd08a19000000bec2bfec', 'byte', Navigation(
        **NAVIGATION, magnetic_heading=-2.8762578, health=VALID_2)),
    ('4e450100030100006400ffff010000000001000000000000823e7e2f', 'word', Accuracy(
        1, None, 0.009587526, 6.2831851641, 1099511627777)),
    ('4e450200020700909cff881378ec60ea19000000536243fe', 'word', Navigation(
        **NAVIGATION, magnetic_heading=5.7525156, health=VALID_2)),
    ('4e450200060915cd5b070000000000005385b2ee', 'byte', SyncPulseTime(9, 123456789)),
    ('4e4502000409c815cd5b070000000000821d2bce', 'word', NavigationTime(9, 200, 123456789)),
    ('4e45030001ffff7f00808ae60100ffff0000490200000000ec38ff15', 'byte', Inertial(
        255, (49.0325388, -49.0340352, -9.7535352), (0.00015979452, -0.00015979452, 0.0),
        (SAFE, RISK, UNAVAILABLE, SAFE, RISK, UNAVAILABLE))),
    ('4e450300020700909cff881378ec60ea9901000038cb4d4f', 'word', Navigation(
        **NAVIGATION, magnetic_heading=5.7525156, health=(SAFE, RISK, SAFE, RISK, SAFE))),
    ('4e4503000f4f535302001100000000005e9c41ca', 'word', SoftwareVersion('OSS', 2, 17)),
    ('4e4503001f130401000000efcdab89ffffffff0072fd8341', 'word', HardwareVersion(
        0x413, (1, 0x89ABCDEF, 0xFFFFFFFF))),
]
# (frame, checksum, padded, message)
SERVICE = [
    ('4e450300f07ff5d032', 'crc32', False, EnterDiagnostics()),
    ('4e450300f03abd8748', 'byte', False, EnterDiagnostics()),
    ('4e450300f00000006131f44f', 'crc32', True, EnterDiagnostics()),
    ('4e450300f0000000b7e85e7b', 'byte', True, EnterDiagnostics()),
    ('4e450300f0000000889d8563', 'word', True, EnterDiagnostics()),
    ('4e450300f1e9c5d745', 'crc32', False, ExitDiagnostics()),
    ('4e450300f18da0464c', 'byte', False, ExitDiagnostics()),
    ('4e450300f2d49a2702a1', 'crc32', False, NvmReadRequest(212)),
    ('4e450300f2d4f5045e37', 'byte', False, NvmReadRequest(212)),
    (f'4e450300f302{PAGE.hex()}dc965f50', 'crc32', False, NvmPage(2, PAGE)),
    (f'4e450300f302{PAGE.hex()}9570e07e', 'byte', False, NvmPage(2, PAGE)),
    ('4e450300fff2ff0a687d24', 'crc32', False, Acknowledgement(0xF2, 0xFF)),
    ('4e450300fff2ff027b8ce8', 'byte', False, Acknowledgement(0xF2, 0xFF)),
]


def as_frame(data):
    """Return data as a frame for the codec."""
    return Frame(0, bytes(data), 'word')


def approximately(message):
    """Return the fields of a message, for comparison with a tolerance."""
    def loosen(value):
        if isinstance(value, float):
            return pytest.approx(value, rel=1e-9, abs=1e-12)
        return tuple(map(loosen, value)) if isinstance(value, tuple) else value
    return {name: loosen(value) for name, value in asdict(message).items()}


def received(chunks, frame_format=None):
    """Return the frames that a new framer finds in these chunks."""
    framer = Framer(frame_format or BahrsFormat())
    return [frame for chunk in chunks for frame in framer.feed(chunk)] + framer.flush()


@pytest.mark.parametrize('payload, filler', [
    (0, 3), (1, 2), (2, 1), (3, 4), (7, 4), (9, 2), (10, 1), (12, 3), (13, 2), (14, 1), (15, 4)])
def test_padding_is_never_none(payload, filler):
    """PAD_LEN = 4 - (5 + LEN) % 4."""
    assert frame_size(payload, padded=True) - frame_size(payload, padded=False) == filler


@pytest.mark.parametrize('payload, padded, size', [
    (15, True, 28), (14, True, 24), (0, False, 9), (0, True, 12), (33, False, 42)])
def test_frame_size(payload, padded, size):
    """Header, payload, padding and checksum."""
    assert frame_size(payload, padded) == size


@independent.properties(100)
@given(st.integers(0, 0xFFFF), st.integers(0, 255), st.binary(max_size=40),
       st.sampled_from((('word', True), ('byte', True), ('crc32', True), ('byte', False),
                        ('crc32', False))))
def test_build_frame_makes_the_frame_of_the_document(version, message_type, payload, variant):
    """In each variant, for any content."""
    assert build_frame(version, message_type, payload, *variant) == \
        independent.make_frame(version, message_type, payload, *variant)


def test_a_word_checksum_without_whole_words_is_refused():
    """An unpadded service message has no whole words."""
    with pytest.raises(ValueError):
        BahrsCodec().encode(NvmReadRequest(1), 3, 'word', padded=False)


@pytest.mark.parametrize('version', [1, 2, 3, 4, 0x454E])
def test_the_version_is_read_from_the_frame(version):
    """Little-endian."""
    assert frame_version(independent.make_frame(version, 1, b'')) == version


@pytest.mark.parametrize('hexadecimal, checksum, message', STREAM)
def test_a_stream_frame_decodes(hexadecimal, checksum, message):
    """The checksum is that of its variant."""
    data = bytes.fromhex(hexadecimal)
    (frame,) = received([data])
    decoded = BahrsCodec().decode(frame)
    assert (frame.data, frame.checksum, type(decoded)) == (data, checksum, type(message))
    assert asdict(decoded) == approximately(message)


@pytest.mark.parametrize('hexadecimal, checksum, message', STREAM)
def test_a_stream_message_encodes(hexadecimal, checksum, message):
    """With padding by default."""
    version = bytes.fromhex(hexadecimal)[2]
    assert BahrsCodec().encode(message, version, checksum).hex() == hexadecimal


def test_a_stream_message_is_encoded_as_the_device_does_by_default():
    """With its CRC in word order."""
    message = STREAM[0][2]
    assert BahrsCodec().encode(message, 2) == FIRST_FRAME


@pytest.mark.parametrize('hexadecimal, checksum, padded, message', SERVICE)
def test_a_service_frame_decodes_in_every_variant(hexadecimal, checksum, padded, message):
    """The checksum is that of its variant."""
    data = bytes.fromhex(hexadecimal)
    (frame,) = received([data])
    assert (frame.data, frame.checksum) == (data, checksum)
    assert BahrsCodec().decode(frame) == message


@pytest.mark.parametrize('hexadecimal, checksum, padded, message', SERVICE)
def test_a_service_message_encodes_in_every_variant(hexadecimal, checksum, padded, message):
    """As requested."""
    assert BahrsCodec().encode(message, 3, checksum, padded).hex() == hexadecimal


@pytest.mark.parametrize('message, hexadecimal', [
    (EnterDiagnostics(), '4e450300f07ff5d032'), (NvmReadRequest(212), '4e450300f2d49a2702a1')])
def test_a_service_message_is_encoded_as_the_makers_tool_does_by_default(message, hexadecimal):
    """Unpadded, with the ordinary CRC-32."""
    assert BahrsCodec().encode(message, 3).hex() == hexadecimal


def test_raw_returns_the_numbers_on_the_wire():
    """Without scales, health as one number."""
    assert BahrsCodec().raw(as_frame(FIRST_FRAME)) == {
        'sequence': 0, 'specific_force': (-43, -30, -6518), 'angular_rate': (-4, 2, 7),
        'health': 0x3F}


def test_the_codec_decodes_and_encodes_a_signed_height_on_request():
    """0x9000 is above 4,500 m unsigned, below ground signed."""
    data = bytes.fromhex('4e450200020700909cff881378ec60ea19000000536243fe')
    codec = BahrsCodec('int16')
    message = codec.decode(as_frame(data))
    assert message.pressure_height == pytest.approx(-5812.57340928)
    assert codec.encode(message, 2) == data


def test_version_2_has_no_hardware_version():
    """Version 3 introduced it."""
    with pytest.raises(ValueError, match='hardware_version.*2'):
        BahrsCodec().encode(HardwareVersion(1, (2, 3, 4)), 2)


@pytest.mark.parametrize('version', [0, 4, 0xFFFF])
def test_an_unknown_version_cannot_be_encoded(version):
    """Its layout is unknown."""
    with pytest.raises(ValueError, match='inertial'):
        BahrsCodec().encode(STREAM[0][2], version)


def test_the_error_of_a_value_out_of_range_names_its_field():
    """The codec raises the error of the layout."""
    with pytest.raises(ValueError, match='velocity_down'):
        BahrsCodec().encode(Navigation(0, 0.0, 301.0, 0.0, 0.0, 0.0, (SAFE,) * 5), 2)


@pytest.mark.parametrize('header, sizes', [
    ('4e45010001', (24,)), ('4e45020001', (24,)), ('4e45030001', (28,)), ('4e45020002', (24,)),
    ('4e45030002', (24,)), ('4e45020003', (28,)), ('4e45020004', (20,)), ('4e45020005', (20,)),
    ('4e45020006', (20,)), ('4e4502000f', (20,)), ('4e4503001f', (24,)),
    ('4e4502001f', ()), ('4e45040001', ()), ('4e45000001', ()), ('4e45020101', ()),
    ('4e450200c0', ()), ('4e450200c1', ()), ('4e45030000', ()), ('', ()), ('4e45', ())])
def test_a_header_determines_the_sizes_of_its_frame(header, sizes):
    """There are none if the type or the version is unknown."""
    assert BahrsFormat().sizes(bytes.fromhex(header)) == sizes


def test_a_new_format_has_seen_nothing():
    """A forced order does not count as seen."""
    for order in ('auto', 'word', 'byte'):
        frame_format = BahrsFormat(order)
        assert (frame_format.order_seen, frame_format.version_seen) == (None, None)


@pytest.mark.parametrize('version', [1, 2, 3])
@pytest.mark.parametrize('order', ['word', 'byte'])
def test_the_order_and_version_of_the_latest_stream_frame_are_seen(order, version):
    """Also after frames of the other kind."""
    frame_format = BahrsFormat()
    other = {'word': 'byte', 'byte': 'word'}[order]
    received([independent.make_frame(version % 3 + 1, 0x06, bytes(9), other),
              independent.make_frame(version, 0x06, bytes(9), order)], frame_format)
    assert (frame_format.order_seen, frame_format.version_seen) == (order, version)


def test_service_frames_do_not_change_the_order_of_the_stream():
    """The maker's tool and the document disagree about them."""
    frame_format = BahrsFormat()
    received([bytes.fromhex(case[0]) for case in SERVICE], frame_format)
    assert (frame_format.order_seen, frame_format.version_seen) == (None, None)


def test_a_rejected_frame_changes_nothing_that_was_seen():
    """Only accepted frames count."""
    frame_format = BahrsFormat()
    received([FIRST_FRAME, independent.make_frame(3, 0x06, bytes(9), 'byte')[:-1] + b'?'],
             frame_format)
    assert (frame_format.order_seen, frame_format.version_seen) == ('word', 2)


def test_a_stream_frame_with_the_ordinary_crc_is_rejected():
    """Only service frames have it."""
    assert received([independent.make_frame(2, 0x01, bytes(14), 'crc32')]) == []


@pytest.mark.parametrize('size', range(13))
def test_a_header_without_a_checksum_is_no_unknown_frame(size):
    """Neither are zeros."""
    assert BahrsFormat().name_unknown((b'NE\x02\x00\xC0' + bytes(8))[:size]) is None


@pytest.mark.parametrize('body', [b'NE', b'NE\x02', b'NE\x02\x00'])
@pytest.mark.parametrize('checksum', ['word', 'byte', 'crc32'])
def test_a_checksum_without_a_whole_header_is_no_unknown_frame(body, checksum):
    """It has no type."""
    check = independent.CHECKSUMS[checksum](body).to_bytes(4, 'little')
    assert BahrsFormat().name_unknown(body + check) is None


def test_an_unknown_frame_may_be_empty():
    """Requests to enter and leave diagnostics mode are empty, too."""
    frame = independent.make_frame(3, 0xF7, b'', 'crc32', padded=False)
    assert BahrsFormat().name_unknown(frame) == '0xF7'


@pytest.mark.parametrize('version, message_type, name', [
    (2, 0xC0, '0xC0'), (3, 0xC1, '0xC1'), (1, 0x07, '0x07'), (2, 0x1F, '0x1F'),
    (4, 0x01, '0x01 of version 4'), (0, 0xFF, '0xFF of version 0')])
@pytest.mark.parametrize('variant', [
    ('word', True), ('byte', True), ('crc32', True), ('byte', False), ('crc32', False)])
def test_an_intact_unknown_frame_is_named(version, message_type, name, variant):
    """With any checksum and padding."""
    frame = independent.make_frame(version, message_type, b'payload', *variant)
    assert BahrsFormat().name_unknown(frame) == name
    assert BahrsFormat().name_unknown(frame[:-1] + bytes([frame[-1] ^ 1])) is None


@independent.properties(300)
@given(independent.known_frames(), st.booleans())
def test_any_intact_frame_decodes_and_encodes_back(data, signed):
    """Except for reserved bits of health, which are cleared."""
    (frame,) = received([data])
    version, message_type = data[2], data[4]
    codec = BahrsCodec('int16' if signed else 'uint16')
    message = codec.decode(frame)
    back = codec.encode(message, version, frame.checksum,
                        message_type < 0xF0 or len(data) == 12)
    if message_type in (0x01, 0x02):
        size = independent.STREAM_PAYLOADS[version, message_type]
        payload = bytearray(data[5:5 + size])
        signals = 6 if message_type == 0x01 else 5
        payload[-1] &= 2 ** signals - 1 if version < 3 else 2 ** (2 * signals - 8) - 1
        data = independent.make_frame(version, message_type, bytes(payload), frame.checksum)
    assert (message.TYPE, back) == (message_type, data)


# The shared vectors

def normalized(name, value):
    """Return a value as the vectors write it."""
    if isinstance(value, bytes):
        return value.hex()
    if name == 'health' and isinstance(value, tuple):
        return [integrity.label for integrity in value]
    return list(value) if isinstance(value, tuple) else value


def test_the_vectors_contain_every_message(vectors):
    """The tests below depend on it."""
    assert {vector['message'] for vector in vectors} == {message.NAME for message in MESSAGES}
    assert len(vectors) >= 88


def test_vectors_decode_to_their_raw_values(vectors):
    """By the names of the fields."""
    codec = BahrsCodec()
    for vector in vectors:
        raw = {name: normalized(name, value)
               for name, value in codec.raw(as_frame(bytes.fromhex(vector['hex']))).items()}
        if 'device_time_us' in raw:
            raw['device_time'] = raw.pop('device_time_us')
        assert raw == vector['raw'], vector


def test_vectors_decode_to_their_si_values(vectors):
    """And to the named message."""
    codec = BahrsCodec()
    for vector in vectors:
        message = codec.decode(as_frame(bytes.fromhex(vector['hex'])))
        assert message.NAME == vector['message'], vector
        for name, value in vector['si'].items():
            exact = name in ('health', 'project') or value is None
            assert normalized(name, getattr(message, name)) == \
                (value if exact else pytest.approx(value, rel=1e-12)), (name, vector)


def test_vectors_of_messages_without_si_decode_to_their_raw_values(vectors):
    """Service messages have plain numbers."""
    codec = BahrsCodec()
    service = [vector for vector in vectors if not vector['si']]
    assert service
    for vector in service:
        message = codec.decode(as_frame(bytes.fromhex(vector['hex'])))
        values = {name: normalized(name, value) for name, value in asdict(message).items()}
        assert values == vector['raw'], vector


def test_vectors_encode_to_their_bytes(vectors):
    """In the named variant."""
    codec = BahrsCodec()
    for vector in vectors:
        message = codec.decode(as_frame(bytes.fromhex(vector['hex'])))
        padded = True if 'padded' in vector['name'] else None
        assert codec.encode(message, vector['version'], vector['crc'], padded).hex() \
            == vector['hex'], vector


def test_vectors_are_found_however_they_are_delivered(vectors):
    """Whole, byte by byte, and between other bytes."""
    for vector in vectors:
        data = bytes.fromhex(vector['hex'])
        expected = [(data, vector['crc'])]
        for lead, trail in ((b'', b''), (b'N', b'N'), (b'\x00E', b'NE'), (b'NE\x03', b'\xff\x00')):
            stream = lead + data + trail
            for chunks in ([stream], [bytes([byte]) for byte in stream]):
                found = received(chunks)
                assert [(frame.data, frame.checksum) for frame in found] == expected, vector
                assert found[0].offset == len(lead), vector


def test_all_vectors_in_one_stream_are_found(vectors):
    """Versions, orders and service frames mixed."""
    frames = [bytes.fromhex(vector['hex']) for vector in vectors]
    assert [frame.data for frame in received([b''.join(frames)])] == frames


# The recording

def test_the_recording_is_of_a_device_at_rest(recording):
    """A wrong scale, sign or order of fields would show."""
    codec = BahrsCodec()
    messages = [codec.decode(frame) for frame in Framer(BahrsFormat()).feed(recording)]
    inertial = [message for message in messages if isinstance(message, Inertial)]
    navigation = [message for message in messages if isinstance(message, Navigation)]
    heights = [message.pressure_height for message in navigation if message.health[0] is SAFE]
    means = [sum(axis) / len(inertial) for axis in zip(*(m.specific_force for m in inertial))]
    assert means == pytest.approx([-0.06, -0.04, -9.75], abs=0.02)
    assert (min(heights), max(heights)) == pytest.approx((537.0, 538.3), abs=0.06)
    assert {message.health[4] for message in navigation} == {UNAVAILABLE}
    assert [any(message.health) for message in navigation[:9]] == [False] * 8 + [True]

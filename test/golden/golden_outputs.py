# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Outputs of the golden files: what node, convert, decode and report make of an input, hashed."""

from collections import defaultdict
from collections.abc import Callable, Iterable
import hashlib
import json
import math
from pathlib import Path

from golden_inputs import as_rules, Input, make_input, RECIPES
from node_path import node_path, polled_path
import numpy as np
from pyproj import Transformer
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
from support.in_process import run_bahrs

Hashes = dict[str, dict[str, object]]
LOG_TIME_DELAY = 120_000        # ns from a read to the log time of its message
MINUTE = 470_000                # bytes of the recording
DIGITS = 9                      # significant ones that remain of the numbers of a report
RAW_TYPE = 'std_msgs/msg/UInt8MultiArray'
STORE = get_typestore(Stores.ROS2_JAZZY)


def arithmetic() -> str:
    """Return a hash that differs between machines whose last digits may differ."""
    values = [function(0.1 + index / 7) for index in range(500) for function in (
        math.sin, math.cos, math.tan, math.exp, math.log, math.atan, math.sqrt,
        lambda x: x ** 0.190263, lambda x: math.atan2(x, 3.7), lambda x: math.hypot(x, 1.1, 2.3),
        lambda x: math.asin(x / 100), lambda x: sum([x] * 10))]
    to_degrees = Transformer.from_crs('EPSG:32632', 'EPSG:4326')
    for index in range(50):
        values += to_degrees.transform(6e5 + 997 * index, 5.2e6 + 991 * index)
    grid = np.linspace(0.1, 70, 1000)
    values += [*np.sin(grid), *np.cos(grid), *np.sqrt(grid), grid.sum(), grid.std()]
    return _sha256(value.hex().encode() for value in map(float, values))


def input_bytes(name: str, folder: Path) -> Hashes:
    """Hash the bytes and the instants of an input."""
    source = make_input(name)
    reads = [read for opening in source.openings for read in opening]
    return {'bytes': _entry([source.data]),
            'reads': _entry(f'{len(data)} {raw} {ros}'.encode() for data, raw, ros in reads)}


def node(name: str, folder: Path) -> Hashes:
    """Hash each topic of the node with default settings."""
    return by_topic(node_path(make_input(name), {}))


def node_other(name: str, folder: Path) -> Hashes:
    """Hash each topic of the node with other settings; of the recording the first minute."""
    source = _shortened(name)
    return by_topic(node_path(source, source.other))


def node_polled(name: str, folder: Path) -> Hashes:
    """Hash each topic of the node that polls a Titan-M."""
    return by_topic(polled_path({}))


def convert_bag(name: str, folder: Path) -> Hashes:
    """Hash the conversion of a bag of raw."""
    return _converted(_raw_bag(make_input(name), folder), folder)


def convert_other(name: str, folder: Path) -> Hashes:
    """Hash the conversion of a bag of raw with other settings."""
    source = make_input(name)
    return _converted(_raw_bag(source, folder), folder, *as_rules(source.other),
                      '--namespace', 'uav')


def convert_csv(name: str, folder: Path) -> Hashes:
    """Hash the conversion of a bag of raw into CSV files."""
    output = folder / 'csv'
    text = _run(folder, 'convert', _raw_bag(make_input(name), folder), output, '--as', 'csv')
    return {'printed': _entry([text]), **{
        file.name: _entry(file.read_bytes().splitlines(keepends=True))
        for file in sorted(output.iterdir())}}


def convert_file(name: str, folder: Path) -> Hashes:
    """Hash the conversion of a file of bytes; of the recording the first minute."""
    return _converted(_byte_file(_shortened(name), folder), folder,
                      '--sensor', RECIPES[name].sensor, '--start', '2026-05-01T12:00:00Z')


def decode(name: str, folder: Path) -> Hashes:
    """Hash what decode prints in each format."""
    source, hashes = make_input(name), {}
    for words in ('--format summary', '--format jsonl', '--format csv', '--json'):
        text = _run(folder, 'decode', *words.split(), '--sensor', source.sensor,
                    _byte_file(source, folder))
        hashes[words.split()[-1].lstrip('-')] = _entry(text.splitlines(keepends=True))
    return hashes


def report(name: str, folder: Path) -> Hashes:
    """Hash the JSON reports of a file of bytes and of a bag, their numbers rounded."""
    source = make_input(name)
    hashes = {}
    for kind, path in (('file', _byte_file(source, folder)), ('bag', _raw_bag(source, folder))):
        status, out, error = run_bahrs('report', '--json', path)
        record = _rounded(json.loads(out)) if out else {}
        hashes[kind] = _entry([json.dumps([status, record]).encode(), _masked(error, folder)])
    return hashes


def by_topic(messages: Iterable[tuple[str, bytes]]) -> Hashes:
    """Hash the messages of each topic."""
    found = defaultdict(list)
    for topic, data in messages:
        found[topic].append(data)
    return {topic: _entry(found[topic]) for topic in sorted(found)}


OUTPUTS: dict[str, Callable[[str, Path], Hashes]] = {
    'input': input_bytes, 'node': node, 'node, other settings': node_other,
    'node, polled': node_polled, 'convert bag': convert_bag,
    'convert bag, other settings': convert_other, 'convert bag into csv': convert_csv,
    'convert file': convert_file, 'decode': decode, 'report': report}
INPUTS = {'convert bag, other settings': {'pulses', 'damaged', 'integrity', 'titan_m'},
          'convert bag into csv': {'integrity', 'titan_m'}, 'node, polled': {'titan_m'}}
CASES = [(name, output) for name in RECIPES for output in OUTPUTS
         if name in INPUTS.get(output, RECIPES)]


def _shortened(name: str) -> Input:
    source = make_input(name)
    return source if RECIPES[name].options else source.beginning(MINUTE)


def _converted(source: Path, folder: Path, *words: str) -> Hashes:
    """Convert a capture; hash each topic, the log times in order, the topics and the notes."""
    output = folder / 'converted'
    hashes = {'printed': _entry([_run(folder, 'convert', source, output, '--json', *words)])}
    if not output.exists():
        return hashes
    with Reader(output) as reader:
        topics = sorted((item.topic, item.msgtype, str(item.ext)) for item in reader.connections)
        messages = [(item.topic, time, data) for item, time, data in reader.messages()]
    return {**hashes, 'offered topics': _entry(repr(topic).encode() for topic in topics),
            'log times': _entry(f'{topic} {time}'.encode() for topic, time, _ in messages),
            **by_topic((topic, data) for topic, _, data in messages)}


def _run(folder: Path, *words: object) -> bytes:
    """Run a verb; return its status and all that it printed, without the name of the folder."""
    status, out, error = run_bahrs(*words)
    return b'\n'.join([str(status).encode(), _masked(out, folder), _masked(error, folder)])


def _masked(text: str, folder: Path) -> bytes:
    return text.replace(str(folder), 'FOLDER').encode()


def _byte_file(source: Input, folder: Path) -> Path:
    path = folder / 'stream.bin'
    path.write_bytes(source.data)
    return path


def _raw_bag(source: Input, folder: Path) -> Path:
    """Write a bag of raw as the node would have published it."""
    path = folder / 'raw_bag'
    kinds = STORE.types
    array, layout, dimension = (kinds[f'std_msgs/msg/{name}'] for name in (
        'UInt8MultiArray', 'MultiArrayLayout', 'MultiArrayDimension'))
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/raw', RAW_TYPE, typestore=STORE)
        for opening, reads in enumerate(source.openings, start=1):
            for data, raw_ns, ros_ns in reads:
                label = (f'sensor={source.sensor} opening={opening} byte_ns=86806 '
                         f'ros_ns={ros_ns} raw_ns={raw_ns}')
                message = array(
                    layout=layout(dim=[dimension(label=label, size=len(data), stride=len(data))],
                                  data_offset=0), data=np.frombuffer(data, np.uint8))
                writer.write(connection, ros_ns + LOG_TIME_DELAY,
                             STORE.serialize_cdr(message, RAW_TYPE))
    return path


def _entry(parts: Iterable[bytes]) -> dict[str, object]:
    parts = list(parts)
    return {'messages': len(parts), 'sha256': _sha256(parts)}


def _sha256(parts: Iterable[bytes]) -> str:
    """Return a hash that also depends on where parts end."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, 'big'))
        digest.update(part)
    return digest.hexdigest()


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return float(f'{value:.{DIGITS}g}')
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    if isinstance(value, dict):
        return {name: _rounded(item) for name, item in value.items()}
    return value

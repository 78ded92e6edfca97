# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Bags made for tests, in every form that rosbag2 writes."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.convert import raw
from bahrs_driver.convert.values import Float64
from bahrs_driver.ros_layout.layouts import serialize
from mcap.writer import CompressionType, Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores

TYPE = 'std_msgs/msg/UInt8MultiArray'
STORE = get_typestore(Stores.ROS2_JAZZY)
METADATA = [ReadMetadata('bahrs', 1 + i // 6, 86805, 10 ** 18 + i, 5 * 10 ** 9 + i)
            for i in range(10)]
PIECES = [bytes(range(i, i + 20)) for i in range(10)]
Items = Iterable[tuple[int, bytes]]         # log times and serialized messages
CHUNKS = [Chunk(data, metadata.ros_ns, metadata.raw_ns, metadata.connection_id)
          for data, metadata in zip(PIECES, METADATA)]


def messages() -> list[tuple[int, bytes]]:
    """Return serialized raw messages with their log times."""
    return [(metadata.ros_ns + 1000, serialize(raw.message(data, metadata.to_label())))
            for data, metadata in zip(PIECES, METADATA)]


def write_bag(path: Path, plugin: StoragePlugin, topics: Sequence[str] = ('/raw',),
              compression: CompressionMode = CompressionMode.NONE,
              items: Items | None = None) -> Path:
    """Write a bag with rosbags; other topics are in it, too."""
    writer = Writer(path, version=9, storage_plugin=plugin)
    writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        number = writer.add_connection('/heading', 'std_msgs/msg/Float64', typestore=STORE)
        connections = [writer.add_connection(topic, TYPE, typestore=STORE) for topic in topics]
        for time, data in messages() if items is None else items:
            writer.write(number, time, serialize(Float64(1.0)))
            for connection in connections:
                writer.write(connection, time, data)
    return path


def write_mcap(path: Path, compression: CompressionType = CompressionType.ZSTD,
               chunk_size: int = 100, items: Items | None = None) -> int:
    """Write an MCAP file in small chunks, and return its size without its end."""
    with path.open('wb') as file:
        writer = McapWriter(file, chunk_size, compression)
        writer.start('ros2')
        text = STORE.generate_msgdef(TYPE, ros_version=2)[0]
        schema = writer.register_schema(TYPE, 'ros2msg', text.encode())
        channel = writer.register_channel('/uav/raw', 'cdr', schema)
        for time, data in messages() if items is None else items:
            writer.add_message(channel, time, data, time)
        end = file.tell()
        writer.finish()  # type: ignore[no-untyped-call]
    return end


def every_form(folder: Path) -> list[Path]:
    """Return the main file of a bag for each storage and compression that there is."""
    files: list[Path] = []
    for plugin in StoragePlugin:
        for mode in CompressionMode:
            if mode == CompressionMode.STORAGE and plugin == StoragePlugin.SQLITE3:
                continue
            bag = write_bag(folder / f'{plugin.name}_{mode.name}', plugin, compression=mode)
            files.extend(file for file in bag.iterdir() if file.name != 'metadata.yaml')
    for compression in CompressionType:
        files.append(folder / f'{compression.name}.mcap')
        write_mcap(files[-1], compression)
    return files

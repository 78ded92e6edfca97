# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read a recording as tables, without ROS."""

from collections.abc import Mapping
from pathlib import Path

from bahrs_driver.devices.registry import DEVICES, parameter_table
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.errors import ParameterError
from bahrs_driver.process.garbage_collection import rare_collections
from bahrs_driver.reprocess.conversion import Conversion
from bahrs_driver.reprocess.recording import no_frames, open_recording
from bahrs_driver.reprocess.recording_settings import recording_settings
from bahrs_driver.settings.table import SENSOR, unknown_parameter
from bahrs_driver.tables.memory_sink import MemorySink
from bahrs_driver.tables.table import Tables
from bahrs_driver.tables.table_files import WITHOUT_RAW
from bahrs_driver.tables.table_writer import TableWriter


def read(path: str | Path, sensor: str | None = None,
         parameters: Mapping[str, object] | None = None, start_ns: int | None = None,
         topic: str | None = None) -> Tables:
    """
    Return the table of each topic that `bahrs convert` makes of a recording, but `raw`.

    path is a file of raw bytes, or a bag with the topic `raw`, which needs the Python package
    mcap. sensor is the value of the parameter `sensor`; without it, the bag names the sensor, or
    it is the default of the parameter. parameters has parameters of the driver by name, such as
    {'frame_convention': 'ned'}. start_ns is the time of the first time message of a file of bytes,
    in ns since 1970; without it, times are device time. topic is that of the raw bytes, if the bag
    has several.

    CaptureError if the recording cannot be read or has no frame of the device, ParameterError for
    an invalid parameter, ValueError for an unknown sensor.
    """
    if sensor not in (None, *DEVICES):
        raise ValueError(f'sensor is {sensor!r}: it must be one of {", ".join(DEVICES)}')
    capture, name = open_recording(path, topic, sensor)
    settings, notes = _settings(parameters or {}, name)
    sinks: dict[str, MemorySink] = {}

    def open_sink(topic: str, kind: type) -> MemorySink:
        sinks[topic] = MemorySink(kind)
        return sinks[topic]

    conversion = Conversion(capture, settings, DEVICES[name], start_ns)
    writer = TableWriter(open_sink, WITHOUT_RAW)
    with rare_collections():
        result = conversion.run(writer, lambda _: None)
    if not result.frames:
        raise no_frames(path, name)
    writer.close()
    return Tables({topic: sink.table() for topic, sink in sinks.items()},
                  [*notes, *capture.notes, *conversion.notices, *result.clock_steps])


def _settings(given: Mapping[str, object], sensor: str) -> tuple[CommonSettings, list[str]]:
    known = parameter_table().by_name
    for name in given:
        if name == SENSOR:
            raise ParameterError('parameters has the name sensor: use the argument sensor')
        if name not in known:
            raise ParameterError(f'parameters has the name {unknown_parameter(name, known)}')
    return recording_settings(given, sensor, lambda name: f'parameter {name}')

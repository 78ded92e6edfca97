# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
ROS 2 driver for serial inertial sensors of unmanned aircraft.

The names in `__all__` are the public interface for scripts. They need no ROS, and only read() and
its tables need numpy; each is imported when it is first used. The messages of a DEVICE are in
bahrs_driver.protocol.DEVICE.messages: dataclasses, in SI units, with a NAME.

Read a recording, a file of bytes or a bag with the topic `raw`, as tables: those that `bahrs
convert` writes. A table has an array for each field of the topic's messages:

>>> import bahrs_driver
>>> tables = bahrs_driver.read('flight.bin', parameters={'frame_convention': 'ned'})
>>> imu = tables['imu/data']
>>> imu['time_ns'].dtype, imu['angular_velocity.x'].shape == (imu.rows,)
(dtype('int64'), True)
>>> imu.stack('linear_acceleration')[0].round(3).tolist(), imu.units['linear_acceleration.z']
([0.0, 0.0, -9.806], 'm/s^2')

`pandas.DataFrame(imu)` and `polars.DataFrame(imu)` take a table as it is.

Decode a file of bytes, or any iterable of bytes. Each message comes with the frame that carried it
and its device time in microseconds, None where that is not known:

>>> with open('flight.bin', 'rb') as file:
...     samples = [(device_time_us, message.specific_force)
...                for frame, message, device_time_us in bahrs_driver.decode(file, 'bahrs')
...                if message.NAME == 'inertial']
>>> samples[0]
(600000, (0.0, 0.0, -9.8059092))

Decode a live stream, and stamp each message with the host's time at which it was measured. An
Instant is the host's time at the end of a read:

>>> device = bahrs_driver.DEVICES['bahrs']
>>> clock = bahrs_driver.SampleClock(device.roles)
>>> pipeline = device.stream_decoder(device.settings(), clock).pipeline
>>> pipeline.open(bahrs_driver.byte_time_ns(115200))
>>> stamps = []
>>> for data, instant in reads:
...     for event in pipeline.feed(data, instant):
...         if isinstance(event, bahrs_driver.Stamped) and event.message.NAME == 'inertial':
...             stamps.append(event.stamp_ns)
>>> round((stamps[-1] - stamps[0]) / (len(stamps) - 1), -3)     # ns from sample to sample
5000000.0

Parse an image of the non-volatile memory of a device, as `bahrs nvm dump` writes it:

>>> with open('device.bin', 'rb') as file:
...     blocks = list(device.memory.parse(file.read()))
>>> [(found.block.NAME, found.intact) for found in blocks][:2]
[('format version', True), ('installation angles', True)]

A Framer alone finds frames in bytes.
"""

from importlib import import_module
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from bahrs_driver.clock import Instant, SampleClock
    from bahrs_driver.devices.registry import DEVICES
    from bahrs_driver.errors import BahrsDriverError
    from bahrs_driver.pipeline import DecodingFault, Notice, Pipeline, Stamped
    from bahrs_driver.protocol.framing import Frame, Framer
    from bahrs_driver.reprocess.decode import decode
    from bahrs_driver.reprocess.read import read
    from bahrs_driver.tables.table import Table, Tables
    from bahrs_driver.units import byte_time_ns

__version__ = '0.1.0'

__all__ = [
    'BahrsDriverError', 'DEVICES', 'DecodingFault', 'Frame', 'Framer', 'Instant', 'Notice',
    'Pipeline', 'SampleClock', 'Stamped', 'Table', 'Tables', '__version__', 'byte_time_ns',
    'decode', 'read']

_MODULES = {
    'clock': ('Instant', 'SampleClock'),
    'devices.registry': ('DEVICES',),
    'errors': ('BahrsDriverError',),
    'pipeline': ('DecodingFault', 'Notice', 'Pipeline', 'Stamped'),
    'protocol.framing': ('Frame', 'Framer'),
    'reprocess.decode': ('decode',),
    'reprocess.read': ('read',),
    'tables.table': ('Table', 'Tables'),
    'units': ('byte_time_ns',)}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used (PEP 562)."""
    if name not in _MODULE_OF:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    value = getattr(import_module(f'{__name__}.{_MODULE_OF[name]}'), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return all names, also those that were not used yet."""
    return sorted({*globals(), *__all__})

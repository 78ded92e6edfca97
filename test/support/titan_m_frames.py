# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Answers of a Titan-M, and the frames of a stream."""

from bahrs_driver.protocol.framing import Frame, FrameFormat, Framer
from bahrs_driver.protocol.titan_m.frames import AnswerFormat
from bahrs_driver.protocol.titan_m.messages import Gps, Sensors, State

STATE = State((1.0, 2.0, -3.0), (0.5, -0.25, 0.0), (0.125, -0.5, 1.5), (0.0, 0.0625, -1.0))
GPS = Gps(1.5, 500_000.0, 5_000_000.0, 600.0, (1.0, 2.0, 3.0), 90.0, 4.0, 3.0, 32, True)
SENSORS = Sensors((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 20.0, (0.0, 0.0, -9.75), (0.0, 0.0, 0.5),
                  95_000.0, 12.5, (0.0, 0.0, 0.0))


def frames_in(data: bytes, frame_format: FrameFormat | None = None,
              size: int | None = None) -> tuple[list[Frame], Framer]:
    """Return the frames of a stream, fed in chunks of a size, and the framer."""
    framer = Framer(frame_format or AnswerFormat())
    frames = []
    size = size or len(data) or 1
    for start in range(0, len(data), size):
        frames += framer.feed(data[start:start + size])
    return frames + framer.flush(), framer

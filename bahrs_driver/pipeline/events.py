# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The events of a stream, in the order in which a pipeline returns them."""

from typing import NamedTuple

from bahrs_driver.clock.interface import Stamped
from bahrs_driver.protocol.framing import Frame


class Notice(NamedTuple):
    """A sentence for the user about a clock: the host's, the device's, or its pulses."""

    text: str


class DecodingFault(NamedTuple):
    """An exception of the decoder. The message of the frame is missing from the stream."""

    frame: Frame
    error: Exception


Event = Stamped | Notice | DecodingFault

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""From bytes to stamped messages: the one pipeline that all users of a stream share."""

from bahrs_driver.clock.interface import Stamped
from bahrs_driver.pipeline.events import DecodingFault, Event, Notice
from bahrs_driver.pipeline.pipeline import Pipeline, PipelineCounters
from bahrs_driver.pipeline.unstamped import Unstamped

__all__ = ['DecodingFault', 'Event', 'Notice', 'Pipeline', 'PipelineCounters',
           'Stamped', 'Unstamped']

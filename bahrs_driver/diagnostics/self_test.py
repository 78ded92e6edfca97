# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The service ~/self_test: the tasks of the diagnostics as tests that pass or fail."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import OK, Verdict
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_msgs.srv import SelfTest

TESTS = {
    'Link': 'Port open and bytes flowing',
    'Framing': 'Frames valid',
    'Rates': 'Rates right',
    'Integrity': 'Integrity safe',
    'Time': 'Clock settled',
    'Requests': 'Requests answered',
    'Device': 'Device plausible',
}


def answer(verdicts: Mapping[str, Verdict], hardware_id: str, device_id: str,
           response: SelfTest.Response) -> SelfTest.Response:
    """Fill in the response from the present state of the tasks; device_id may be empty."""
    response.id = device_id or hardware_id
    response.status = [
        DiagnosticStatus(level=verdicts[task].level, name=test, message=verdicts[task].message,
                         hardware_id=hardware_id)
        for task, test in TESTS.items() if task in verdicts]
    response.passed = bytes([all(status.level == OK for status in response.status)])
    return response

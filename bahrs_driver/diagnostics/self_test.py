# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Answer the service ~/self_test: each diagnostic task is a test that passes or fails."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import OK, Summary
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_msgs.srv import SelfTest

# Names of the tests, by task.
TESTS = {
    'Link': 'Port open and bytes flowing',
    'Framing': 'Frames valid',
    'Rates': 'Rates right',
    'Integrity': 'Integrity safe',
    'Time': 'Clock settled',
    'Requests': 'Requests answered',
    'Device': 'Device plausible',
}


def answer(summaries: Mapping[str, Summary], hardware_id: str, device_id: str,
           response: SelfTest.Response) -> SelfTest.Response:
    """Fill in the response from the present state of the tasks; device_id may be empty."""
    response.id = device_id or hardware_id
    response.status = [
        DiagnosticStatus(level=summaries[task].level, name=test, message=summaries[task].message,
                         hardware_id=hardware_id)
        for task, test in TESTS.items() if task in summaries]
    response.passed = bytes([all(status.level == OK for status in response.status)])
    return response

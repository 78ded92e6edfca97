# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Generated files match the code: tables of the README, and parameter files."""

from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools'))

from bahrs_driver.devices.registry import DEVICES  # noqa: E402
from parameter_files import FOLDER, parameter_file  # noqa: E402
import pytest  # noqa: E402
from readme_tables import missing_topics, PAGES, README, with_tables  # noqa: E402


def test_tables_are_those_of_the_code():
    """`make docs` writes them."""
    text = ''.join(page.read_text() for page in PAGES)
    assert with_tables(text) == text
    assert '| `port` |' in text and '| a silent device | Link | ERROR |' in text
    assert '| `angular_velocity.x`, `.y`, `.z` | rad/s |' in text


def test_every_topic_is_named_with_its_type():
    """In the table of topics."""
    assert missing_topics(README.read_text()) == []


@pytest.mark.parametrize('spec', DEVICES.values(), ids=list(DEVICES))
def test_parameter_file_matches_the_settings(spec):
    """`make docs` writes it."""
    assert (FOLDER / f'{spec.name}.yaml').read_text() == parameter_file(spec)

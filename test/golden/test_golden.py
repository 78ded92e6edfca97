# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Tests that the output of node, convert, decode and report is, byte for byte, as stored.

hashes.json has a SHA-256 and a count for each output of each input. If an output changes on
purpose, store it again and explain the change in the commit:

    .venv/bin/python -m pytest test/golden --write-golden

Each case with a changed value prints the change and fails, although the value is then stored;
the next run without the option passes. `git diff test/golden/hashes.json` shows the same.

Hashes of computed values hold for one arithmetic: the last digits of sin() or pow() differ between
versions of libm, numpy and PROJ and between processors, and sum() changed in Python 3.12. A
fingerprint of the arithmetic is stored beside the hashes. On another arithmetic the tests compare
the counts and skip, except for the bytes and the decoded messages of the recording, which no such
function enters. To compare all there, store the hashes with the commit before the change first.
Numbers of a report are rounded to 9 significant digits.

The recording is beside the repository; its cases skip where it is absent.
"""

import json
from pathlib import Path

from golden_inputs import make_input
from golden_outputs import arithmetic, by_topic, CASES, OUTPUTS
from node_path import node_path
import pytest

FILE = Path(__file__).with_name('hashes.json')
FINGERPRINT = 'arithmetic'
EXACT = {('recording', 'input'), ('recording', 'decode')}      # no function of libm enters


def stored():
    """Return all stored hashes."""
    return json.loads(FILE.read_text()) if FILE.exists() else {}


def changes(before, after):
    """Return a line for each output that differs."""
    return [f'{name}: {before.get(name, "absent")} -> {after.get(name, "absent")}'
            for name in sorted({*before, *after}) if before.get(name) != after.get(name)]


def counts(hashes):
    """Return the number of messages of each output."""
    return {name: entry['messages'] for name, entry in hashes.items()}


def write(name, output, hashes):
    """Store the hashes of one case, one output a line."""
    known = stored()
    known.setdefault(name, {})[output] = hashes
    known[FINGERPRINT] = arithmetic()
    lines = [f'{json.dumps(FINGERPRINT)}: {json.dumps(known.pop(FINGERPRINT))}']
    for source in sorted(known):
        blocks = []
        for kind in sorted(known[source]):
            rows = ',\n'.join(f'      {json.dumps(topic)}: {json.dumps(entry)}'
                              for topic, entry in sorted(known[source][kind].items()))
            blocks.append(f'    {json.dumps(kind)}: {{\n{rows}\n    }}')
        lines.append(f'{json.dumps(source)}: {{\n' + ',\n'.join(blocks) + '\n  }')
    FILE.write_text('{\n  ' + ',\n  '.join(lines) + '\n}\n')


@pytest.mark.parametrize('name, output', CASES, ids=lambda word: word.replace(', ', '-'))
def test_output_is_as_stored(name, output, tmp_path, request):
    """Byte for byte, or in the number of messages on a machine that computes otherwise."""
    before = stored()
    expected = before.get(name, {}).get(output, {})
    found = OUTPUTS[output](name, tmp_path)
    if request.config.getoption('--write-golden', default=False):
        write(name, output, found)
    elif (name, output) not in EXACT and before[FINGERPRINT] != arithmetic():
        assert counts(found) == counts(expected)
        pytest.skip('another libm, numpy, PROJ or processor: only the counts are compared')
    assert found == expected, '\n'.join(changes(expected, found))


def test_every_stored_case_is_compared():
    """Nothing stored is left over from a case that is gone."""
    assert {(name, output) for name, outputs in stored().items() if name != FINGERPRINT
            for output in outputs} == set(CASES)


def test_a_small_change_is_found():
    """Of one number in one topic, in an otherwise equal output."""
    source = make_input('titan_m')
    first, second = (by_topic(node_path(source, {'stddev.temperature': stddev}))
                     for stddev in (0.5, 0.5 + 1e-15))
    assert counts(first) == counts(second)
    (line,) = changes(first, second)
    assert line.startswith('temperature: ')


def test_a_changed_byte_is_found():
    """Of an input, and a byte that moved from one message to the next."""
    messages = by_topic([('a', b'one'), ('a', b'two')])
    assert changes(messages, by_topic([('a', b'one'), ('a', b'two')])) == []
    for others in ([b'one', b'twp'], [b'onet', b'wo'], [b'two', b'one'], [b'one']):
        assert len(changes(messages, by_topic([('a', data) for data in others]))) == 1

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The fields of message objects by flat names, found without the layouts of the driver."""

from collections.abc import Iterator
import json
from typing import Any


def flat(message: Any, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Yield name and value of each field; arrays are numbered, sequences are JSON texts."""
    for field, kind in message.get_fields_and_field_types().items():
        name, value = prefix + field, getattr(message, field)
        if kind.startswith('sequence<'):
            yield name, json.dumps(_plain(value))
        elif kind.endswith(']'):
            yield from ((f'{name}.{index}', item) for index, item in enumerate(value.tolist()))
        elif hasattr(value, 'get_fields_and_field_types'):
            yield from flat(value, f'{name}.')
        else:
            yield name, value


def _plain(value: Any) -> Any:
    if hasattr(value, 'get_fields_and_field_types'):
        return {name: _plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return value[0]
    return list(map(_plain, value)) if hasattr(value, '__iter__') \
        and not isinstance(value, str) else value

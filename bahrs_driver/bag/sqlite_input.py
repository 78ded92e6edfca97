# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read SQLite files of rosbag2, in the order in which messages were written.

The order of time stamps differs from it if the clock was set during the recording.
"""

from collections.abc import Iterator
import contextlib
from pathlib import Path
import sqlite3

from bahrs_driver.bag.damage import Damage, MESSAGE
from bahrs_driver.bag.stored_message import LARGEST_PART, RAW_TYPE, StoredMessage
from bahrs_driver.errors import DamageError

# Large data is not read: length() reads its header only. CROSS keeps the order of the tables,
# which saves sorting.
_MESSAGES = """
    SELECT messages.id, topics.name, messages.timestamp,
           CASE WHEN length(messages.data) <= ? THEN messages.data END
    FROM messages CROSS JOIN topics ON messages.topic_id = topics.id
    WHERE topics.type = ? ORDER BY messages.id"""


def read_sqlite(file: Path, damage: Damage) -> Iterator[tuple[StoredMessage, float]]:
    """Yield raw messages and the share of the file that is read; DamageError at damage."""
    with contextlib.closing(_connection(file)) as connection:
        _check(connection)
        last = connection.execute('SELECT max(id) FROM messages').fetchone()[0] or 1
        for number, topic, log_time, data in connection.execute(
                _MESSAGES, (LARGEST_PART, RAW_TYPE)):
            with damage.skip_if_damaged(MESSAGE):
                if not isinstance(data, bytes) or not isinstance(log_time, int):
                    raise DamageError('it has no data, or too much')
                yield StoredMessage(topic, log_time, data), number / last


def _connection(file: Path) -> sqlite3.Connection:
    """Open a database for reading, with the log of a recorder that was killed."""
    file = file.resolve()
    has_log = file.with_name(f'{file.name}-wal').exists()
    # Without a log, SQLite must create no file beside it; with a log, it may not be able to.
    for options in ('mode=ro', 'immutable=1') if has_log else ('immutable=1',):
        connection = sqlite3.connect(f'{file.as_uri()}?{options}', uri=True)
        connection.text_factory = lambda text: text.decode(errors='replace')
        try:
            connection.execute('SELECT count(*) FROM sqlite_master')
            return connection
        except sqlite3.DatabaseError as error:
            connection.close()
            reason = error
    raise DamageError(reason)


def _check(connection: sqlite3.Connection) -> None:
    """Raise DamageError if the tables are not plain ones: a view can compute without end."""
    found = connection.execute(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND sql NOT LIKE '%VIRTUAL%' "
        "AND name IN ('messages', 'topics')").fetchall()
    if len(found) != 2:
        raise DamageError('it has no tables of a bag')

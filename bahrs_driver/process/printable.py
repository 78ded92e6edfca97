# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Make text from other sources safe to print.

Names of ports, labels of bags, project codes and fields of ROS messages come from other sources.
An escape sequence in one of them would control the terminal, and a line feed would forge a line of
the log. printable() escapes every such text before the user sees it.
"""

LONGEST_TEXT = 500          # characters; a longer text is cut


def printable(text: object, limit: int = LONGEST_TEXT) -> str:
    r"""
    Return a text on one line, without characters that a terminal acts on.

    Control characters, line and paragraph separators, marks of writing direction, and bytes that
    could not be decoded are written as escapes, such as \x1b. A text of more than limit
    characters ends in an ellipsis.
    """
    shown = ''.join(map(_printable_character, str(text)[:limit + 1]))
    return shown if len(shown) <= limit else f'{shown[:limit - 1]}…'


def _printable_character(character: str) -> str:
    if character.isprintable():
        return character
    code = ord(character)
    if 0xdc80 <= code <= 0xdcff:        # a byte that surrogateescape carried through
        return f'\\x{code - 0xdc00:02x}'
    return f'\\x{code:02x}' if code < 0x100 else f'\\u{code:04x}' if code < 0x10000 \
        else f'\\U{code:08x}'

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Draw an artificial horizon with characters.

Each character cell is two pixels, one above the other, which are about square. Sky and ground
also differ in their characters, so the picture can be read without colours.
"""

from collections.abc import Iterator
from itertools import groupby
import math

from rich.style import Style
from rich.text import Text

FIELD_OF_VIEW = 50.0    # degrees of pitch from bottom to top
RUNG_SPACING = 10.0     # degrees of pitch from one rung of the ladder to the next
RUNG_HALF_LENGTH = 0.16         # as a share of the width
DEGREES_PER_CELL = 4.0          # of the heading tape

_SKY, _GROUND, _LINE = '#0f5fa8', '#7a4a14', '#ffffff'
_EDGE = Style(color=_GROUND, bgcolor=_SKY)
# By whether the upper and the lower pixel are ground.
_CELLS = {(False, False): (' ', Style(color=_LINE, bgcolor=_SKY)),
          (True, True): ('░', Style(color='#a06a2a', bgcolor=_GROUND)),
          (False, True): ('▄', _EDGE), (True, False): ('▀', _EDGE)}
_RUNG_STYLES = {False: Style(color=_LINE, bgcolor=_SKY),
                True: Style(color=_LINE, bgcolor=_GROUND)}
_AIRCRAFT = Style(color='#ffd700', bold=True)
_UNKNOWN = Style(color='red', bold=True)


def horizon(roll: float, pitch: float, width: int, height: int) -> Text:
    """
    Return the picture of an attitude, in width x height characters.

    Angles are in degrees: roll to the right and pitch upward are positive.
    """
    rows = [list(_row(roll, pitch, width, height, row)) for row in range(height)]
    for column, character in _aircraft(width):
        _, style = rows[height // 2][column]
        rows[height // 2][column] = character, style + _AIRCRAFT
    return Text('\n').join(_line(row) for row in rows)


def no_horizon(width: int, height: int, why: str) -> Text:
    """Return an empty picture with the reason why there is no attitude."""
    lines = [' ' * width] * height
    lines[height // 2] = why[:width].center(width)
    return Text('\n'.join(lines), style=_UNKNOWN)


def heading_tape(heading: float, width: int) -> Text:
    """Return the compass around a heading in degrees, which is in the middle."""
    tape = [' '] * width
    for azimuth in range(0, 360, 10):
        away = (azimuth - heading + 180.0) % 360.0 - 180.0
        column = width // 2 + round(away / DEGREES_PER_CELL)
        label = {0: 'N', 90: 'E', 180: 'S', 270: 'W'}.get(
            azimuth, f'{azimuth // 10:02d}' if azimuth % 30 == 0 else '·')
        start = column - (len(label) - 1) // 2
        if 0 <= start and start + len(label) <= width:
            tape[start:start + len(label)] = label
    text = Text(''.join(tape), style='bold')
    text.stylize('reverse', width // 2, width // 2 + 1)
    return text


def _row(roll: float, pitch: float, width: int, height: int,
         row: int) -> Iterator[tuple[str, Style]]:
    scale = 2 * height / FIELD_OF_VIEW      # pixels per degree
    cos, sin = math.cos(math.radians(roll)), math.sin(math.radians(roll))
    for column in range(width):
        x = column - (width - 1) / 2
        # Distances above the horizon of the two pixels, and of their middle, in pixels.
        upper, lower = (
            (height - 2 * row - half - 0.5) * cos - x * sin + pitch * scale for half in (0, 1))
        middle = (upper + lower) / 2
        along_rung = x * cos + (height - 2 * row - 1) * sin
        rung = round(middle / scale / RUNG_SPACING)
        if rung and abs(middle - rung * RUNG_SPACING * scale) < 0.75 \
                and abs(along_rung) < RUNG_HALF_LENGTH * width:
            yield '─' if abs(sin) < 0.4 else '·', _RUNG_STYLES[middle < 0]
        else:
            yield _CELLS[upper < 0, lower < 0]


def _aircraft(width: int) -> Iterator[tuple[int, str]]:
    middle, wing = (width - 1) // 2, max(2, width // 8)
    yield middle, '╋'
    for side in (-1, 1):
        for step in range(wing, 2 * wing):
            yield middle + side * step, '━'


def _line(cells: list[tuple[str, Style]]) -> Text:
    line = Text()
    for style, run in groupby(cells, key=lambda cell: cell[1]):
        line.append(''.join(character for character, _ in run), style)
    return line

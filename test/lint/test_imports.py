# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Imports point inward; the pure rooms reach nothing but the standard library."""

import ast
from pathlib import Path
import sys

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / 'bahrs_driver'
MODULES = sorted(PACKAGE.rglob('*.py'))

# Every room, and the rooms of ours that it may import. A module directly in the package is a
# room of its own.
MAY_IMPORT = {
    'protocol': {'protocol'},
    'clock': {'clock', 'protocol'},
    'latched_publisher': set(),
    'transport': {'transport', 'clock', 'host_time'},
    'link': {'transport', 'clock'},
    'receiver': {'link', 'fault_log', 'clock', 'protocol'},
    'convert': {'convert', 'clock', 'protocol'},
    'emulator': {'emulator', 'clock', 'files', 'host_time', 'protocol'},
    'parameter': set(),
    'parameters': {'parameter'},
    'files': {'files'},
    'settings': {'parameter', 'parameters', 'settings'},
    'nvm_reader': {'link', 'protocol'},
    'requester': {'link', 'clock', 'host_time', 'protocol'},
    'nvm_dump': {'files'},
    'nvm_services': {'fault_log', 'convert', 'files', 'nvm_dump', 'nvm_reader', 'protocol'},
    'sensors': {'clock', 'convert', 'diagnostics', 'nvm_reader', 'receiver', 'requester',
                'sensors', 'link', 'protocol'},
    'diagnostics': {'clock', 'diagnostics', 'fault_log', 'node_names', 'receiver', 'link',
                    'transport', 'protocol'},
    'recording': {'driver_graph', 'executor', 'host_time', 'node_names', 'recording', 'sensors',
                  'convert', 'diagnostics', 'receiver', 'clock', 'protocol', 'files'},
    'report': {'report', 'recording', 'clock', 'protocol'},
    'doctor': {'doctor', 'diagnostics', 'driver_graph', 'convert', 'link', 'node_names',
               'ros_start', 'transport', 'protocol'},
    'driver_graph': {'convert', 'node_names'},
    'node_names': set(),
    'ros_start': {'settings'},
    'monitor': {'monitor', 'convert', 'diagnostics', 'driver_graph', 'node_names'},
    'driver_node': {'node_process', 'ros_start', 'shutdown_event', 'standard_streams'},
    'node_process': {'executor', 'exit_timer', 'node', 'parameter', 'ros_start', 'settings',
                     'shutdown_event'},
    'node': {'parameter', 'settings', 'sensors', 'clock', 'convert', 'recording', 'diagnostics',
             'nvm_services', 'receiver', 'latched_publisher', 'link', 'fault_log', 'sim_time',
             'subscriber_gate'},
    'host_time': {'clock'},
    'printable': set(),
    'fault_log': set(),
    'exit_timer': set(),
    'shutdown_event': {'exit_timer'},
    'sim_time': set(),
    'standard_streams': set(),
    'subscriber_gate': set(),
    'launching': set(),
    'executor': set(),
    'cli': {'cli', 'doctor', 'monitor', 'report', 'convert', 'emulator', 'recording', 'sensors',
            'parameter', 'parameters', 'settings', 'nvm_reader', 'files', 'exit_timer',
            'shutdown_event', 'standard_streams', 'fault_log', 'receiver', 'link', 'clock',
            'driver_graph', 'node_names', 'ros_start', 'protocol'},
    '__init__': set(),
}
EVERYWHERE = {'printable'}      # rooms that every room may import
DEAF = {'protocol', 'clock'}
NEVER_IN_DEAF = {'time', 'threading', 'socket', 'select', 'os', 'subprocess', 'asyncio', 'io'}


def room(path: Path) -> str:
    """Return the folder, or the name of a module directly in the package."""
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else path.stem


def imported(path: Path) -> set[str]:
    """Return the full names of all modules that a module imports, wherever in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f'{path}: relative import'
            names |= {node.module} | {f'{node.module}.{alias.name}' for alias in node.names}
    return names


def our_rooms(path: Path) -> set[str]:
    """Return the rooms of this package that a module imports."""
    inside = {name.split('.')[1] for name in imported(path) if name.startswith('bahrs_driver.')}
    return {name for name in inside if name in MAY_IMPORT}


def test_every_module_stands_in_a_known_room():
    """A new room is entered in the table above, with what it may import."""
    assert {room(path) for path in MODULES} <= set(MAY_IMPORT)


@pytest.mark.parametrize('path', MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_inward(path):
    """No room imports one that is further out."""
    assert our_rooms(path) <= MAY_IMPORT[room(path)] | EVERYWHERE


@pytest.mark.parametrize('path', [path for path in MODULES if room(path) in DEAF],
                         ids=lambda path: str(path.relative_to(PACKAGE)))
def test_the_core_is_deaf(path):
    """Only the standard library (batch.py: and numpy), and nothing of it that waits or listens."""
    outside = {name.split('.')[0] for name in imported(path)} - {'bahrs_driver'}
    allowed = set(sys.stdlib_module_names) - NEVER_IN_DEAF
    assert outside <= allowed | ({'numpy'} if path.name == 'batch.py' else set())


def test_only_the_transport_imports_serial():
    """One place knows pyserial."""
    assert {room(path) for path in MODULES
            if any(name.split('.')[0] == 'serial' for name in imported(path))} == {'transport'}

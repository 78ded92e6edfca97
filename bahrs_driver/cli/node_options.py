# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The options that select a driver."""

import argparse
from collections.abc import Sequence

from bahrs_driver.cli import ros_arguments
from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import ROOT, Selection, split_name
from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name


def add_node_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that select a driver."""
    parser.add_argument('--node', default='', metavar='NAME',
                        help='driver node, such as /left/bahrs_driver; a name without / is '
                             'found in any namespace (default: the only running driver)')
    parser.add_argument('--namespace', metavar='NAME',
                        help='namespace of the driver node, / for the root (default: any)')


def selected_node(options: argparse.Namespace) -> Selection:
    """Return the selected driver; CommandError for invalid or contradictory options."""
    namespace = selected_namespace(options)
    if '/' not in options.node:
        if options.node:
            _check_node_name(options.node)
        return Selection(options.node, namespace)
    name, node_namespace = split_name(options.node)
    if options.node.startswith('/'):
        node_namespace = checked_namespace(node_namespace) or ROOT
        if options.namespace is not None and node_namespace != namespace:
            raise CommandError(f'--node {options.node} is not in --namespace {namespace}: leave '
                               'one of them out')
    else:
        node_namespace = checked_namespace(f"{namespace.rstrip('/')}/{node_namespace}")
    _check_node_name(name)
    return Selection(name, node_namespace)


def selected_namespace(options: argparse.Namespace) -> str:
    """Return the selected namespace, / for the root; empty for any."""
    text = options.namespace
    if text is None:
        text = ros_arguments.namespace(options.ros_arguments)
    return '' if text is None else checked_namespace(text) or ROOT


def several_nodes(names: Sequence[str]) -> CommandError:
    """Return the error for several matching nodes."""
    shown = [printable(name) for name in names]
    return CommandError(f'{", ".join(shown[:-1])} and {shown[-1]} run: choose one with --node '
                        f'{shown[0]}')


def checked_namespace(text: str) -> str:
    """Return a namespace such as /left, or '' for the root; CommandError if it is invalid."""
    name = text.strip('/')
    try:
        validate_namespace(f'/{name}')
    except (InvalidNamespaceException, TypeError, ValueError) as error:
        raise CommandError(f'{text!r} is not a namespace: write a name such as /left') from error
    return f'/{name}' if name else ''


def _check_node_name(text: str) -> None:
    try:
        validate_node_name(text)
    except (InvalidNodeNameException, TypeError, ValueError) as error:
        raise CommandError(f'{text!r} is not the name of a node: use letters, digits and _, '
                           'after its namespace if you give one') from error

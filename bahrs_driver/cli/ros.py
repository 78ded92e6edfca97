# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What verbs that use ROS check before it, which would answer with a traceback."""

import os

from bahrs_driver.cli.errors import CommandError
from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name

HIGHEST_DOMAIN = 232            # above, its ports would be beyond 65535


def checked_namespace(text: str) -> str:
    """Return a namespace as /left, or nothing for the outermost; CommandError if it is none."""
    name = text.strip('/')
    try:
        validate_namespace(f'/{name}')
    except InvalidNamespaceException as error:
        raise CommandError(f'{text!r} is no namespace: it must be a name such as '
                           '/left') from error
    return f'/{name}' if name else ''


def check_node_name(text: str) -> None:
    """Raise CommandError if a text is no name of a node."""
    try:
        validate_node_name(text)
    except InvalidNodeNameException as error:
        raise CommandError(f'{text!r} is no name of a node: it must have letters, digits and _ '
                           'only, and its namespace goes into --namespace') from error


def check_domain() -> None:
    """Raise CommandError if the environment has a domain that ROS cannot take."""
    text = os.environ.get('ROS_DOMAIN_ID', '')
    if text and not (text.isdecimal() and int(text) <= HIGHEST_DOMAIN):
        raise CommandError(f'ROS_DOMAIN_ID is {text!r}: it must be a number from 0 to 101')

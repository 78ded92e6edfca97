# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Parameter files: the reason why rcl rejects one, and the nodes that one has parameters for.

rcl reads the values. This module reads a file again to explain a problem, so it skips files that
cannot be read twice, such as pipes.
"""

from collections.abc import Iterator
from pathlib import Path
import re
from typing import Any

from bahrs_driver.process.printable import printable
import yaml

LARGEST = 10_000_000        # bytes; a larger file is no parameter file
VALUES_KEY = 'ros__parameters'


def is_pipe(file: str) -> bool:
    """Return whether a file is a pipe or device, which may give its content only once."""
    path = Path(file)
    return path.exists() and not path.is_file() and not path.is_dir()


def file_problem(file: str) -> str | None:
    """Return a sentence about why a file cannot be used; None if no reason is found."""
    name = printable(file)
    try:
        _load(file)
    except OSError as error:
        return (f'parameter file {name} cannot be read: {error.strerror}: check the path after '
                '--params-file')
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        return (f'parameter file {name} is not valid YAML: correct line {line}: '
                f'{printable(error.problem)}')
    except (ValueError, RecursionError, yaml.YAMLError):
        return f'parameter file {name} is not a YAML file: check the path after --params-file'
    return None


def other_nodes(file: str, node: str) -> list[str] | None:
    """Return the node names in a file; None if one of them matches a fully qualified name."""
    try:
        documents = _load(file)
    except (OSError, ValueError, RecursionError, yaml.YAMLError):
        return None
    if documents is None:
        return None
    names = [name for document in documents for name in _node_names(document)]
    return None if any(matches_node(name, node) for name in names) else list(dict.fromkeys(names))


def matches_node(pattern: str, node: str) -> bool:
    """Return whether a name in a file, perhaps with * or **, matches a node, as in rclpy."""
    absolute = pattern if pattern.startswith('/') else f'/{pattern}'
    try:
        return re.fullmatch(absolute.replace('/*', r'(/\w+)'), node, re.ASCII) is not None
    except re.error:
        return False


def _load(file: str) -> list[Any] | None:
    """Return the documents in a file, with all values as text; None if it is a pipe."""
    text = load_text(file)
    return None if text is None else list(yaml.load_all(text, Loader=yaml.BaseLoader))


def load_text(file: str) -> str | None:
    """Return the text of a file, None if it is a pipe; OSError or ValueError if it has none."""
    if is_pipe(file):
        return None
    with open(file, 'rb') as stream:
        data = stream.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise ValueError('too large')
    return data.decode()


def _node_names(tree: Any, prefix: str = '') -> Iterator[str]:
    """Yield the names of nodes that have parameters in a document, as rcl joins them."""
    if not isinstance(tree, dict):
        return
    for key, value in tree.items():
        if str(key).startswith(VALUES_KEY):
            yield prefix
        else:
            yield from _node_names(value, f'{prefix}/{key}' if prefix else str(key))

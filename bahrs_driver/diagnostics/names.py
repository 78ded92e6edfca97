# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Names of statuses on /diagnostics: "node: task", as in diagnostic_updater.

In the root namespace, a status has the bare name of the node. In others it has the fully qualified
name (use_fqn in diagnostic_updater): otherwise two drivers of the same name would share entries.
"""

from bahrs_driver.ros.node_names import full_name, ROOT

_SEPARATOR = ': '


def node_label(name: str, namespace: str, qualified: bool = False) -> str:
    """Return the first part of the names of a node's statuses; qualified is for the root."""
    bare = namespace in ('', ROOT) and not qualified
    return name if bare else full_name(name, namespace)


def status_name(label: str, task: str) -> str:
    """Return the name of a status."""
    return f'{label}{_SEPARATOR}{task}'


def parse_status_name(text: str) -> tuple[str, str]:
    """Return the fully qualified name of the node and the task; no node if there is none."""
    label, separator, task = text.partition(_SEPARATOR)
    if not separator:
        return '', text
    return (label if label.startswith(ROOT) else f'{ROOT}{label}'), task

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Names of statuses on /diagnostics: "node: task", as diagnostic_updater makes them.

The node is given by its bare name at the root. In a namespace it is given by its fully qualified
name (diagnostic_updater's use_fqn), or two drivers of the same name would share their entries.
"""

from bahrs_driver.ros.node_names import full_name, ROOT

_SEPARATOR = ': '


def node_label(name: str, namespace: str, qualified: bool = False) -> str:
    """Return what the statuses of a node begin with; qualified asks for the full name always."""
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

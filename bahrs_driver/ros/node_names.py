# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Names of nodes, and the selection of one of the running nodes."""

from collections.abc import Iterable
from typing import NamedTuple

ROOT = '/'
USUAL_NAME = 'bahrs_driver'     # default name of a driver
SETTLE_TIME = 5.0       # s after the first match; a second one within makes the choice ambiguous


def full_name(name: str, namespace: str) -> str:
    """Return the fully qualified name of a node."""
    return f"/{namespace.strip('/')}/{name}" if namespace.strip('/') else f'/{name}'


def split_name(full: str) -> tuple[str, str]:
    """Return name and namespace of a fully qualified name."""
    namespace, _, name = full.rpartition('/')
    return name, namespace or ROOT


class Selection(NamedTuple):
    """The node that a user selects: by name, by namespace, by both, or any."""

    name: str = ''
    namespace: str = ''         # empty: any; /: the root

    @property
    def exact(self) -> str:
        """Fully qualified name; empty if name or namespace is not selected."""
        return full_name(*self) if self.name and self.namespace else ''

    def matches(self, full: str) -> bool:
        """Return whether a node of this fully qualified name is selected."""
        name, namespace = split_name(full)
        return self.name in ('', name) and self.namespace in ('', namespace)

    def __str__(self) -> str:
        """Describe the selection, for messages."""
        noun = f'node named {self.name}' if self.name else 'driver'
        return f'{noun} in namespace {self.namespace}' if self.namespace else noun


class NodeChoice:
    """
    The selected node, among the nodes that discovery finds over time.

    The first match is chosen at once, to miss no data of it. If another one appears soon after,
    the selection was ambiguous.
    """

    def __init__(self, selection: Selection) -> None:
        self.selection = selection
        self.chosen = selection.exact
        self.several: list[str] = []
        self._settled_at: float | None = None

    def settled(self, now: float) -> bool:
        """Return whether another node cannot make the choice ambiguous any more."""
        return bool(self.selection.exact) or \
            self._settled_at is not None and now > self._settled_at

    def offer(self, names: Iterable[str], now: float) -> None:
        """Choose among the full names of running nodes, at a monotonic time in seconds."""
        matches = sorted({name for name in names if self.selection.matches(name)})
        if self.selection.exact or not matches:
            return
        if self._settled_at is None:
            self._settled_at = now + SETTLE_TIME
        if not self.chosen:
            self.chosen = matches[0]
        found = sorted({self.chosen, *matches})
        if len(found) > 1 and not self.settled(now):
            self.several = found

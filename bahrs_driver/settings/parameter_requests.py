# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The services that set parameters at run time: a change takes effect or is refused with the reason.

Those of rclpy raise what ends without a response for a type that is not defined, and accept what
nothing reads.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from bahrs_driver.errors import ParameterError
from bahrs_driver.process.printable import printable
from bahrs_driver.settings.table import BY_NAME
from bahrs_driver.settings.unused import unknown_parameter, why_unused
from rcl_interfaces.msg import Parameter as ParameterMessage, SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService


class ParameterRequests(ParameterService):
    """The services of a node that was made with start_parameter_services=False."""

    def __init__(self, node: Node, settings: Mapping[str, Any]) -> None:
        self._node = node
        self._settings = settings
        super().__init__(node)      # type: ignore[no-untyped-call]

    def _set_parameters_callback(
            self, request: SetParameters.Request,
            response: SetParameters.Response) -> SetParameters.Response:
        response.results = [self._set([message]) for message in request.parameters]
        return response

    def _set_parameters_atomically_callback(
            self, request: SetParametersAtomically.Request,
            response: SetParametersAtomically.Response) -> SetParametersAtomically.Response:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: Sequence[ParameterMessage]) -> SetParametersResult:
        try:
            parameters = [self._checked(message) for message in messages]
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return self._node.set_parameters_atomically(parameters)

    def _checked(self, message: ParameterMessage) -> Parameter:
        """Return a parameter with the value that it is to have; ParameterError says why not."""
        name = message.name
        if not self._node.has_parameter(name):
            known = list(self._node.get_parameters_by_prefix(''))
            raise ParameterError(f'cannot set {unknown_parameter(name, known)}')
        try:
            given: Parameter = Parameter.from_parameter_msg(message)
        except (ValueError, TypeError) as error:
            raise ParameterError(f'parameter {name} cannot have a value of type '
                                 f'{message.value.type}: {printable(error)}') from error
        parameter = BY_NAME.get(name)
        if parameter is None:
            return given
        reason = why_unused(parameter, self._settings)
        if reason:
            raise ParameterError(f'parameter {name} has no effect: {reason}')
        if parameter.read_only:
            raise ParameterError(f'parameter {name} is read when the driver starts: restart it '
                                 f'with -p {name}:=VALUE')
        return Parameter(name, value=parameter.convert(given.value))

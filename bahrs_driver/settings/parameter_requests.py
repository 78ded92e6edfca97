# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The services that set parameters at run time: a change takes effect or is refused with the reason.

The services of rclpy fail without a response if the type of a value is undefined, and accept
changes of parameters that nothing reads.
"""

from collections.abc import Sequence

from bahrs_driver.errors import ParameterError
from bahrs_driver.process.printable import printable
from bahrs_driver.settings.group import DeviceSettings
from bahrs_driver.settings.node_settings import NodeSettings
from bahrs_driver.settings.table import unknown_parameter
from rcl_interfaces.msg import Parameter as ParameterMessage, SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter


class ParameterRequests:
    """Handles the requests that set parameters of a node, in place of rclpy."""

    def __init__(self, node: Node, settings: NodeSettings[DeviceSettings]) -> None:
        self._node = node
        self._settings = settings
        for service in node.services:
            if service.srv_type is SetParameters:
                service.callback = self._set_each
            elif service.srv_type is SetParametersAtomically:
                service.callback = self._set_together

    def _set_each(self, request: SetParameters.Request,
                  response: SetParameters.Response) -> SetParameters.Response:
        response.results = [self._set([message]) for message in request.parameters]
        return response

    def _set_together(self, request: SetParametersAtomically.Request,
                      response: SetParametersAtomically.Response
                      ) -> SetParametersAtomically.Response:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: Sequence[ParameterMessage]) -> SetParametersResult:
        try:
            parameters = [self._checked(message) for message in messages]
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return self._node.set_parameters_atomically(parameters)

    def _checked(self, message: ParameterMessage) -> Parameter:
        """Return a valid parameter; ParameterError says why it cannot be set."""
        name = message.name
        if not self._node.has_parameter(name):
            known = list(self._node.get_parameters_by_prefix(''))
            raise ParameterError(f'cannot set {unknown_parameter(name, known)}')
        try:
            given: Parameter = Parameter.from_parameter_msg(message)
        except (ValueError, TypeError) as error:
            raise ParameterError(f'parameter {name} cannot have a value of type '
                                 f'{message.value.type}: {printable(error)}') from error
        parameter = self._settings.table.by_name.get(name)
        if parameter is None:
            return given
        reason = self._settings.why_unused(name)
        if reason:
            raise ParameterError(f'parameter {name} has no effect: {reason}')
        if parameter.read_only:
            raise ParameterError(f'parameter {name} is read when the driver starts: restart it '
                                 f'with -p {name}:=VALUE')
        return Parameter(name, value=parameter.convert(given.value))

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write the parameter files in config/ from the settings of the devices."""

import json
from pathlib import Path
import textwrap

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.settings.group import parameters
from bahrs_driver.settings.parameter import Parameter

FOLDER = Path(__file__).resolve().parents[1] / 'config'
INDENT = ' ' * 4
HEADER = """\
# Parameters of the driver for a {label}. `make docs` generates this file from the code; copy it to
# change it. A parameter is commented out if it has no effect beside the others, or if its default
# depends on others or on the launch file.
#
# The key /** is for a node of any name in any namespace. Write /left/bahrs_driver for one of
# several. Give each device a port that survives replugging, such as one of /dev/serial/by-id.
/**:
  ros__parameters:
    sensor: {name}
"""


def parameter_file(spec: AnyDevice) -> str:
    """Return the text of the parameter file for a device."""
    settings = spec.settings().for_file()
    unused = {name for name, _ in settings.unused()}
    return HEADER.format(label=spec.label, name=spec.name) + ''.join(
        _entry(row, row.name not in unused and row.in_file) for row in parameters(settings))


def _entry(row: Parameter, is_set: bool) -> str:
    comment = textwrap.fill(row.description, 99, initial_indent=INDENT + '# ',
                            subsequent_indent=INDENT + '# ')
    unit = f'    # {row.unit}' if row.unit else ''
    return f'\n{comment}\n{INDENT}{"" if is_set else "# "}{row.name}: {_yaml(row)}{unit}\n'


def _yaml(row: Parameter) -> str:
    # YAML takes a number for a text unless it has a point.
    text = row.default if isinstance(row.default, str) else json.dumps(row.default)
    return text.replace('e-', '.0e-') if isinstance(row.default, float) and '.' not in text \
        else text


def main() -> None:
    """Write all parameter files."""
    for spec in DEVICES.values():
        (FOLDER / f'{spec.name}.yaml').write_text(parameter_file(spec))


if __name__ == '__main__':
    main()

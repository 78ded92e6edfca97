# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write the tables of the README from the code that they describe."""

from pathlib import Path
import re
import sys

from bahrs_driver.convert.bahrs.converter import TOPICS as BAHRS_TOPICS
from bahrs_driver.convert.titan_m.converter import TOPICS as TITAN_TOPICS
from bahrs_driver.settings.parameter import Parameter
from bahrs_driver.settings.table import PARAMETERS

README = Path(__file__).resolve().parents[1] / 'README.md'


def parameter_table() -> str:
    """Return the parameters as a Markdown table."""
    rows = ['| parameter | default | valid | what it is |', '|---|---|---|---|']
    rows += [f'| `{parameter.name}` | {_default(parameter)} | {_valid(parameter)} '
             f'| {parameter.description} |' for parameter in PARAMETERS]
    return '\n'.join(rows)


def with_tables(text: str) -> str:
    """Return the README with its generated part made anew."""
    pattern = re.compile(r'(<!-- parameters -->\n).*?(<!-- end -->)', re.DOTALL)
    return pattern.sub(lambda match: match[1] + parameter_table() + '\n' + match[2], text)


def missing_topics(text: str) -> list[str]:
    """Return the topics that the README does not name with their type."""
    topics = {**BAHRS_TOPICS, **TITAN_TOPICS}
    return [topic for topic, kind in topics.items()
            if not re.search(rf'\| `{topic}` \| \w+/{kind.__name__} \|', text)]


def _default(parameter: Parameter) -> str:
    if isinstance(parameter.default, bool):
        return str(parameter.default).lower()
    unit = parameter.unit and ' ' + parameter.unit
    return f'`{parameter.default}`{unit}'


def _valid(parameter: Parameter) -> str:
    if parameter.choices:
        return ', '.join(f'`{choice}`' for choice in parameter.choices)
    if parameter.low is not None:
        return f'{"0, " if parameter.or_zero else ""}{parameter.low} to {parameter.high}'
    return 'true or false' if isinstance(parameter.default, bool) else 'any text'


def main() -> int:
    """Write the README; 1 if it lacks a topic."""
    text = README.read_text()
    README.write_text(with_tables(text))
    missing = missing_topics(text)
    if missing:
        print(f'the README lacks: {", ".join(missing)}', file=sys.stderr)
    return bool(missing)


if __name__ == '__main__':
    sys.exit(main())

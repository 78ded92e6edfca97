# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What README and docs show can be typed: commands, parameters, Python."""

from pathlib import Path
import re
import shlex

from bahrs_driver.cli.main import _parser, VERBS
from bahrs_driver.devices.registry import parameter_table
import pytest
from support.emulated import make_emulation, on_the_wire

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / 'README.md', *sorted((ROOT / 'docs').glob('*.md'))]
BLOCK = re.compile(r'^```(\w*)\n(.*?)^```$', re.MULTILINE | re.DOTALL)
INLINE = re.compile(r'`([^`\n]+)`')
PLACEHOLDER = re.compile(r'\b[A-Z]+\b')
ONLY_NAMED = {'bahrs', *(f'bahrs {verb}' for verb in VERBS)}
PARAMETER = re.compile(r'-p ([\w.]+):=')


def shown():
    """Return each command, line or expression that a page shows, with the page's name."""
    found = []
    for page in PAGES:
        text = page.read_text()
        for language, block in BLOCK.findall(text):
            if language != 'python':
                found += [(page.name, line.split(' # ')[0].strip()) for line in block.splitlines()]
        found += [(page.name, line) for line in INLINE.findall(BLOCK.sub('', text))]
    return found


def commands(first):
    """Return what pages show that begins with a word, without placeholders."""
    return sorted({line for _, line in shown()
                   if line.split(' ')[0] == first and not PLACEHOLDER.search(line)
                   and line not in ONLY_NAMED})


@pytest.mark.parametrize('line', commands('bahrs'))
def test_commands_are_taken(line):
    """By the command line; nothing is run."""
    words = shlex.split(line)[1:]
    assert _parser(words[0]).parse_args(words).verb == words[0]


def test_verbs_exist():
    """Those that are only named, too."""
    assert {line.split()[1] for _, line in shown() if line.startswith('bahrs ')} <= set(VERBS)


@pytest.mark.parametrize('line', commands('make'))
def test_make_has_the_target(line):
    """With the variables that it knows."""
    makefile = (ROOT / 'Makefile').read_text()
    target, *variables = line.split()[1:]
    assert re.search(rf'^{re.escape(target)}:', makefile, re.MULTILINE)
    for variable in variables:
        assert f"$({variable.split('=')[0]})" in makefile


def test_parameters_exist():
    """Those of commands on any page."""
    named = {name for _, line in shown() for name in PARAMETER.findall(line)}
    assert {'port', 'publish.raw'} <= named <= parameter_table().by_name.keys()


def test_files_exist():
    """Those of this repository that pages name or link to."""
    for page in PAGES:
        text = page.read_text()
        for name in re.findall(r'\]\((?!http|#)([^)#]+)', text):
            assert (page.parent / name).exists(), name
        for name in re.findall(r'`((?:config|launch|bench|docs|tools)/[\w./-]+)`', text):
            assert (ROOT / name).exists(), name


def test_links_within_a_page_lead_somewhere():
    """To a heading."""
    for page in PAGES:
        text = page.read_text()
        anchors = {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')
                   for heading in re.findall(r'^#+ (.*)$', text, re.MULTILINE)}
        assert set(re.findall(r'\]\(#([^)]+)\)', text)) <= anchors


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.name)
def test_python_runs(page, capsys, tmp_path, monkeypatch):
    """Block after block, with the names and the file that a reader has to fill in."""
    data = on_the_wire(make_emulation(), 2.0)[1]
    (tmp_path / 'flight.bin').write_bytes(data)
    monkeypatch.chdir(tmp_path)
    names = {'some_bytes': data, 'reads_of_a_port': [data[:9000], data[9000:]]}
    for language, block in BLOCK.findall(page.read_text()):
        if language == 'python' and 'LaunchDescription' not in block:
            exec(block, names)          # our own text
            assert capsys.readouterr().out.strip()

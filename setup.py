# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How the package is built and installed."""

from glob import glob
from pathlib import Path
import re

from setuptools import find_packages, setup

PACKAGE = 'bahrs_driver'
VERSION = re.search("__version__ = '(.*)'", Path(PACKAGE, '__init__.py').read_text())

setup(
    name=PACKAGE,
    version=VERSION[1],
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={PACKAGE: ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (f'share/{PACKAGE}', ['package.xml']),
        (f'share/{PACKAGE}/config', glob('config/*')),
        (f'share/{PACKAGE}/launch', glob('launch/*.py')),
        (f'share/{PACKAGE}/rviz', glob('rviz/*')),
        (f'share/{PACKAGE}/urdf', glob('urdf/*')),
    ],
    install_requires=['numpy', 'pyproj', 'pyserial', 'pyyaml', 'rich', 'setuptools'],
    extras_require={
        'tools': ['matplotlib>=3.5', 'mcap>=1.6', 'rosbags>=0.11'],
        'parquet': ['pyarrow>=16'],
        'test': ['hypothesis', 'pytest'],       # by which colcon knows what to test with
    },
    python_requires='>=3.10',
    zip_safe=True,
    maintainer='The bahrs_driver authors',
    maintainer_email='maintainers@bahrs-driver.invalid',
    description='Driver for the BAHRS and Titan-M sensors of unmanned aircraft.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'bahrs = bahrs_driver.cli.main:main',
            'driver_node = bahrs_driver.node.main:main',
        ],
    },
)

# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A Python process in which no package of ROS can be imported."""

import subprocess
import sys

ROS = ('rclpy', 'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'nav_msgs',
       'rcl_interfaces', 'rosidl_parser', 'rpyutils', 'sensor_msgs', 'std_msgs', 'std_srvs',
       'tf2_msgs')
REFUSE = f"""
import sys

class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {ROS}:
            raise ModuleNotFoundError(name, name=name)

sys.meta_path.insert(0, Refuse())
"""


def run_without_ros(code: str, *arguments: object) -> str:
    """Run Python code; return what it prints, or fail with its errors."""
    done = subprocess.run([sys.executable, '-c', REFUSE + code, *map(str, arguments)],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout

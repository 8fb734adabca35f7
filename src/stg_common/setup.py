"""Catkin's view of the Python sources; not for pip."""

from distutils.core import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["stg_common"], package_dir={"": "python"}))

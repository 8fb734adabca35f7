"""A study: many trainings and evaluations, and the tables and figures made of them."""

import os
import sys

_HERE = os.path.dirname(os.path.realpath(__file__))
# Where auv_common has stg_common: in the sources, and installed.
sys.path += [
    os.path.normpath(os.path.join(_HERE, relative))
    for relative in ("../../../auv_common/scripts", "../../auv_common")
]

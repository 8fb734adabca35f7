"""Loads a program as a module, for its tests."""

import importlib.machinery
import importlib.util
import os
import sys


def load_program(path):
    """Returns the file of a program as a module. It finds the modules in its folder, as when it runs."""
    path = os.path.realpath(path)
    name = os.path.basename(path).partition(".")[0]
    sys.path.insert(0, os.path.dirname(path))
    loader = importlib.machinery.SourceFileLoader(name, path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module
    loader.exec_module(module)
    return module

"""The options that a command line states."""

import argparse


def stated(parser, arguments):
    """Returns the names of the options that `arguments` state. Other options have their defaults."""
    # argparse sets no default where the namespace has a value already.
    unset = dict.fromkeys(vars(parser.parse_args(arguments)))
    found = vars(parser.parse_args(arguments, argparse.Namespace(**unset)))
    return {name for name, value in found.items() if value is not None}

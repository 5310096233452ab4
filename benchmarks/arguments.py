# SPDX-License-Identifier: Apache-2.0
"""Types of arguments for the command lines beside it."""
import argparse


def whole(least):
    """A whole number of at least that."""
    def read(text):
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{text} is below {least}")
        return value
    read.__name__ = "whole number"
    return read

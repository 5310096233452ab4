# SPDX-License-Identifier: Apache-2.0


class Error(Exception):
    """Something is wrong with what was given, or with the world around (a full disk). The message is one line: the file and the
    line where there are any, what was found and what was expected.

    >>> airtruth.DataSet("no such folder")
    Traceback (most recent call last):
    airtruth.Error: no such folder: ...
    """

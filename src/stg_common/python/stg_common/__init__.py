"""Common parts of the Python programs of all packages: files of users, and the end of a program."""

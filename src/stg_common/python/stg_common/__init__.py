"""What the Python programs of all packages share: files that users give, and how a program ends."""

#!/usr/bin/python3
"""roslaunch that tells by its exit status whether the run went well.

Takes roslaunch's arguments and does what it does, with two differences. A node that exits with
status 2 refuses its configuration (stg::RunNode): the run ends at once, where respawning would
repeat it for ever. And the exit status is 1 after that, or when a required node died with an error.
"""

import os
import signal
import sys

import roslaunch
import roslaunch.parent
import roslaunch.pmon

REFUSED = 2


class Watch(roslaunch.pmon.ProcessListener):
    """Hears of every process that dies by itself."""

    def __init__(self):
        self.required = set()
        self.failure = ""
        self.refused = False
        self.started = False

    def end_if_refused(self):
        """Ends the run as Ctrl-C does, but not while roslaunch is still starting nodes."""
        if self.refused and self.started:
            os.kill(os.getpid(), signal.SIGINT)

    def process_died(self, process_name, exit_code):
        """Called by roslaunch's monitor; a process is named as its node, with a number behind."""
        node = process_name.rsplit("-", 1)[0]
        if self.failure or not exit_code:
            return
        if exit_code == REFUSED:
            self.failure = f"/{node} refuses its configuration (its message is above)"
            self.refused = True
            self.end_if_refused()
        elif node in self.required:
            self.failure = f"/{node} died with exit status {exit_code}"


def main():
    """Launches; returns the exit status."""
    watch = Watch()

    class Parent(roslaunch.parent.ROSLaunchParent):
        """The parent of a launch, watched from its first process on."""

        def _init_runner(self):
            super()._init_runner()
            watch.required = {
                (node.namespace + node.name).strip("/")
                for node in self.config.nodes
                if node.required
            }
            self.runner.add_process_listener(watch)

        def start(self, *arguments, **options):
            super().start(*arguments, **options)
            watch.started = True
            watch.end_if_refused()

    roslaunch.parent.ROSLaunchParent = Parent
    roslaunch.main()
    if watch.failure:
        print(f"stg: the run failed: {watch.failure}", file=sys.stderr)
    return 1 if watch.failure else 0


if __name__ == "__main__":
    sys.exit(main())

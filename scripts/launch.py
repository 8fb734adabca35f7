#!/usr/bin/python3
"""roslaunch that tells by its exit status whether the run went well.

Takes roslaunch's arguments and does what it does, with three differences. A node that exits with
status 2 refuses its configuration (stg::RunNode): the run ends at once, where respawning would
repeat it for ever. The exit status is 1 after that, or when a required node died with an error. And
nothing is left running when a required node dies while others start, where roslaunch gives up
before its monitor has stopped them.
"""

import os
import signal
import sys

import roslaunch
import roslaunch.parent
import roslaunch.pmon

REFUSED = 2
MONITOR_ENDS_S = 30  # a node has 15 s after SIGINT and 2 s after SIGTERM


class Watch(roslaunch.pmon.ProcessListener):
    """Hears of every process that dies by itself."""

    def __init__(self):
        self.required = set()
        self.failure = ""
        self.refused = False
        self.started = False
        self.monitor = None
        self.processes = []

    def observe(self, monitor):
        """Remembers what the monitor is given to look after."""
        self.monitor = monitor
        register = monitor.register

        def remember(process):
            self.processes.append(process)
            register(process)

        monitor.register = remember

    def stop_the_rest(self):
        """Waits for the monitor to stop its processes, then stops those that started too late."""
        if self.monitor:
            self.monitor.join(MONITOR_ENDS_S)
        for process in reversed(self.processes):  # the master came first and ends last
            if process.started and process.is_alive():
                process.stop([])

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
            watch.observe(self.pm)

        def start(self, *arguments, **options):
            super().start(*arguments, **options)
            watch.started = True
            watch.end_if_refused()

    roslaunch.parent.ROSLaunchParent = Parent
    status = 0
    try:
        roslaunch.main()
    except SystemExit as gave_up:
        status = gave_up.code
    finally:
        watch.stop_the_rest()
    if watch.failure:
        print(f"stg: the run failed: {watch.failure}", file=sys.stderr)
        return 1
    return status


if __name__ == "__main__":
    sys.exit(main())

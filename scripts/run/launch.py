#!/usr/bin/env -S --block-signal=INT /usr/bin/python3
"""Runs roslaunch. The exit status says if the run went well.

It takes roslaunch's arguments and does the same, with these differences. Problems that can be known in
advance are refused before anything starts, in one line (run_arguments.py, run_checks.py). If a node exits
with status 2, it refuses its configuration (stg::RunNode), and the run ends at once; respawning would repeat
this forever. The run also ends, silently, if nothing reads its output any more. The exit status is 1 after
that, if a required node, the recorder or the master died, or if a requested file was not written. It is 130
after a Ctrl-C before everything was started. Nothing stays running if the start ends early; roslaunch itself
would exit before its monitor has stopped all processes.
"""

import stg_common.quiet_start  # first import: Ctrl-C is blocked until here
import argparse
import os
import re
import signal
import sys

import rosgraph.network
import roslaunch
import roslaunch.parent
import roslaunch.pmon
import run_arguments
import run_checks

import stg_common.program
from stg_common.program import INTERRUPTED, NOBODY_READS

REFUSED, LOST_OUTPUT = 2, 4
ON_LOOPBACK = "libauv_common_nodes.so"  # makes the XML-RPC server of roscpp listen at the address of ROS_IP
MONITOR_ENDS_S = 30  # a node has 15 s after SIGINT and 2 s after SIGTERM
# Each AUV includes the launch file of the next one.
sys.setrecursionlimit(100 * run_arguments.MOST_AGENTS)


class Interrupted(BaseException):
    """Ctrl-C while a launch starts. roslaunch catches every Exception."""


def node_of(process_name):
    """Returns the node of a process. Its name is that of the node and a number."""
    return re.sub(r"-[0-9]+$", "", process_name)


class Watch(roslaunch.pmon.ProcessListener):
    """Is notified of every process that dies by itself."""

    def __init__(self):
        self.required = {"master"}
        self.recorders = set()
        self.failure = ""
        self.over = False  # a node refused its configuration, or nothing reads the output
        self.unread = False
        self.started = False
        self.interrupted = False  # by Ctrl-C, before everything was started
        self.names = []
        self.monitor = None
        self.processes = []
        self.popens = {}  # {name: newest process}; roslaunch forgets it together with its process
        self.outputs = None

    def take(self, config):
        """Stores what a launch is about to start. Refuses what cannot work."""
        nodes = {(node.namespace + node.name).strip("/"): node for node in config.nodes}
        parameters = {name: parameter.value for name, parameter in config.params.items()}
        self.names = ["/" + name for name in nodes]
        run_checks.check_numbers(parameters)
        run_checks.check_bags_are_there(config.nodes)
        if run_checks.master_is_online(config.master.uri):
            run_checks.check_names_are_free(config.master.uri, self.names)
        for node in config.nodes_core:  # rosout, which launch files cannot configure
            node.env_args.append(("LD_PRELOAD", ON_LOOPBACK))
        self.required |= {name for name, node in nodes.items() if node.required}
        self.recorders = {name for name, node in nodes.items() if run_checks.bag_of(node)}
        self.outputs = run_checks.Outputs(config.nodes, parameters)
        self.outputs.check_before()

    def observe(self, monitor):
        """Remembers the processes that the monitor gets."""
        self.monitor = monitor
        # roslaunch does the same at its first process, and would call the previous handler.
        signal.signal(signal.SIGINT, roslaunch.pmon.rl_signal)
        for name in ("register", "register_core_proc"):
            setattr(monitor, name, self.remembering(getattr(monitor, name)))

    def remembering(self, register):
        """Returns the function, extended to remember the processes that it gets."""

        def remember(process):
            self.end_if_interrupted()
            if process not in self.processes:
                self.processes.append(process)
                self.keep_popen(process)
            register(process)

        return remember

    def keep_popen(self, process):
        """Keeps the object with the exit status for every start of a process."""
        start = process.start

        def started(*arguments):
            answer = start(*arguments)
            self.popens[process.name] = process.popen
            return answer

        process.start = started
        self.popens[process.name] = getattr(process, "popen", None)

    def stop_the_rest(self):
        """Waits for the monitor to stop its processes, then stops those that started too late."""
        if self.monitor:
            self.monitor.join(MONITOR_ENDS_S)
        for process in reversed(self.processes):  # the master was started first and ends last
            if process.started and process.is_alive():
                process.stop([])

    def stopping(self, stop):
        """Returns roslaunch's signal handler, extended so that a process that is just starting is stopped,
        too."""

        def stop_or_wait(number, frame):
            if number == signal.SIGINT and not self.started:
                self.interrupted = True
            else:
                stop(number, frame)

        return stop_or_wait

    def end_if_interrupted(self):
        """Ends a start that Ctrl-C has interrupted."""
        if self.interrupted:
            raise Interrupted

    def start_ended(self):
        """Called when roslaunch has started everything. Does what had to wait for this."""
        self.end_if_interrupted()
        self.started = True
        self.end_if_over()

    def end_if_over(self):
        """Ends the run as Ctrl-C does, but not while roslaunch is still starting nodes."""
        if self.over and self.started:
            os.kill(os.getpid(), signal.SIGINT)

    def output_unread(self):
        """Called when the reader of the output has disappeared."""
        self.over = self.unread = True
        self.end_if_over()

    def process_died(self, process_name, exit_code):
        """Called by roslaunch's monitor."""
        node = node_of(process_name)
        if self.failure or self.unread:
            return
        if node in self.recorders:
            full = self.outputs.full_disks()
            self.failure = f"/{node} ended before the run, with exit status {exit_code}{full}"
        if not exit_code:
            return
        if exit_code == REFUSED:
            self.failure = f"/{node} refuses its configuration (its message is above)"
            self.over = True
            self.end_if_over()
        elif node in self.required:
            self.failure = f"/{node} died with exit status {exit_code}"

    def judge(self):
        """Checks the files that the run had to write."""
        if self.failure or self.unread or not self.outputs or not self.started:
            return
        for name, popen in self.popens.items():
            if popen and popen.returncode == LOST_OUTPUT:
                self.failure = f"/{node_of(name)} has lost output (its message is above)"
                return
        try:
            self.outputs.check_after()
        except run_checks.Refusal as refusal:
            self.failure = str(refusal)


def master_of(words):
    """Returns the address of the master of a command line, and makes roslaunch use it.

    Without this, it would use the master of the environment for any port, even if that belongs to another
    run.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-p", "--port")
    port = parser.parse_known_args(words)[0].port
    if port:
        os.environ["ROS_MASTER_URI"] = rosgraph.network.create_local_xmlrpc_uri(port)
    return os.environ.get("ROS_MASTER_URI", "http://localhost:11311")


def check_before_loading(words):
    """Refuses input at which roslaunch would fail or hang. Returns the address of the master."""
    run_arguments.check(words)
    # Nodes run in ROS_HOME, so a path relative to the present folder would be another folder for them.
    for name in ("ROS_HOME", "ROS_LOG_DIR"):
        if os.environ.get(name):
            os.environ[name] = os.path.abspath(os.environ[name])
    master = master_of(words)
    run_checks.master_is_online(master)
    run_checks.check_log_folder()
    return master


def launch(watch, turn):
    """Runs roslaunch under watch; returns its exit status.

    @param turn  the turn to start on the master; released when everything is started
    """

    class Parent(roslaunch.parent.ROSLaunchParent):
        """The parent of a launch. It is watched from its first process on."""

        def _load_config(self):
            super()._load_config()
            try:
                watch.take(self.config)
            except run_checks.Refusal as refusal:
                watch.failure = str(refusal)
                raise SystemExit(1) from None

        def _init_runner(self):
            super()._init_runner()
            self.runner.add_process_listener(watch)
            watch.observe(self.pm)

        def start(self, *arguments, **options):
            try:
                super().start(*arguments, **options)
                watch.start_ended()
            except Interrupted:
                self.shutdown()
                raise
            turn.give_up_when_known(self.config.master.uri, watch.names)

    roslaunch.parent.ROSLaunchParent = Parent
    roslaunch.pmon.rl_signal = watch.stopping(roslaunch.pmon.rl_signal)
    try:
        roslaunch.main()
    except SystemExit as gave_up:
        return gave_up.code
    except Interrupted:
        return INTERRUPTED
    finally:
        watch.stop_the_rest()
    return 0


def main():
    """Launches; returns the exit status."""
    watch = Watch()
    status = 0
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is not None:
            setattr(sys, name, stg_common.program.Unread(getattr(sys, name), watch.output_unread))
    try:
        master = check_before_loading(sys.argv[1:])
        with run_checks.Turn(master) as turn:
            status = launch(watch, turn)
        watch.judge()
    except run_checks.Refusal as refusal:
        watch.failure = str(refusal)
    if watch.failure:
        print(f"stg: the run failed: {watch.failure}", file=sys.stderr)
        return 1
    return NOBODY_READS if watch.unread else status


if __name__ == "__main__":
    sys.exit(main())

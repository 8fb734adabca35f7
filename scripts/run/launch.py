#!/usr/bin/env -S --block-signal=INT /usr/bin/python3
"""roslaunch that tells by its exit status whether the run went well.

Takes roslaunch's arguments and does what it does, with these differences. What can be known not to
work is refused before anything starts, in one line (run_arguments.py, run_checks.py). A node that
exits with status 2 refuses its configuration (stg::RunNode): the run ends at once, where respawning
would repeat it for ever. So it does, without a word, when its output has no reader any more. The exit
status is 1 after that, when a required node, the recorder or the master died, or when a file that
was asked for was not written; it is 130 after a Ctrl-C that came before everything was started. And
nothing is left running when the start ends early, where roslaunch gives up before its monitor has
stopped what runs.
"""

import stg_common.quiet_start  # first: until here Ctrl-C is blocked
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
ON_LOOPBACK = "libauv_common_nodes.so"  # lets XML-RPC of roscpp listen where ROS_IP says
MONITOR_ENDS_S = 30  # a node has 15 s after SIGINT and 2 s after SIGTERM
# Each AUV includes the launch file of the next one.
sys.setrecursionlimit(100 * run_arguments.MOST_AGENTS)


class Interrupted(BaseException):
    """Ctrl-C while a launch starts. roslaunch catches every Exception."""


def node_of(process_name):
    """Returns the node of a process, which is named as it is, with a number behind."""
    return re.sub(r"-[0-9]+$", "", process_name)


class Watch(roslaunch.pmon.ProcessListener):
    """Hears of every process that dies by itself."""

    def __init__(self):
        self.required = {"master"}
        self.recorders = set()
        self.failure = ""
        self.over = False  # a node refused its configuration, or its output has no reader
        self.unread = False
        self.started = False
        self.interrupted = False  # by Ctrl-C, before all was started
        self.names = []
        self.monitor = None
        self.processes = []
        self.popens = {}  # {name: the newest}, which roslaunch forgets with the process
        self.outputs = None

    def take(self, config):
        """Notes what a launch is about to start; refuses what cannot work."""
        nodes = {(node.namespace + node.name).strip("/"): node for node in config.nodes}
        parameters = {name: parameter.value for name, parameter in config.params.items()}
        self.names = ["/" + name for name in nodes]
        run_checks.check_numbers(parameters)
        run_checks.check_bags_are_there(config.nodes)
        if run_checks.master_is_online(config.master.uri):
            run_checks.check_names_are_free(config.master.uri, self.names)
        for node in config.nodes_core:  # rosout, to which launch files have nothing to say
            node.env_args.append(("LD_PRELOAD", ON_LOOPBACK))
        self.required |= {name for name, node in nodes.items() if node.required}
        self.recorders = {name for name, node in nodes.items() if run_checks.bag_of(node)}
        self.outputs = run_checks.Outputs(config.nodes, parameters)
        self.outputs.check_before()

    def observe(self, monitor):
        """Remembers what the monitor is given to look after."""
        self.monitor = monitor
        # roslaunch does the same with its first process, and would call what was there before.
        signal.signal(signal.SIGINT, roslaunch.pmon.rl_signal)
        for name in ("register", "register_core_proc"):
            setattr(monitor, name, self.remembering(getattr(monitor, name)))

    def remembering(self, register):
        """Returns the function, made to remember the processes it is given."""

        def remember(process):
            self.end_if_interrupted()
            if process not in self.processes:
                self.processes.append(process)
                self.keep_popen(process)
            register(process)

        return remember

    def keep_popen(self, process):
        """Keeps what tells the exit status, of every life of a process."""
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
        for process in reversed(self.processes):  # the master came first and ends last
            if process.started and process.is_alive():
                process.stop([])

    def stopping(self, stop):
        """Returns roslaunch's answer to signals, made not to leave behind what is just starting."""

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
        """Called when roslaunch has started all; does what could not be done meanwhile."""
        self.end_if_interrupted()
        self.started = True
        self.end_if_over()

    def end_if_over(self):
        """Ends the run as Ctrl-C does, but not while roslaunch is still starting nodes."""
        if self.over and self.started:
            os.kill(os.getpid(), signal.SIGINT)

    def output_unread(self):
        """Called when what reads the output has left."""
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
        """Looks for what the run was asked to write and has not written."""
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
    """Returns the address of the master that a command line means, and has roslaunch mean it.

    It would ask the master of the environment, whatever the port, which run it belongs to.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-p", "--port")
    port = parser.parse_known_args(words)[0].port
    if port:
        os.environ["ROS_MASTER_URI"] = rosgraph.network.create_local_xmlrpc_uri(port)
    return os.environ.get("ROS_MASTER_URI", "http://localhost:11311")


def check_before_loading(words):
    """Refuses what roslaunch would stumble over or hang on; returns the address of the master."""
    run_arguments.check(words)
    # Nodes run in ROS_HOME: what is relative to where we are would be another folder to them.
    for name in ("ROS_HOME", "ROS_LOG_DIR"):
        if os.environ.get(name):
            os.environ[name] = os.path.abspath(os.environ[name])
    master = master_of(words)
    run_checks.master_is_online(master)
    run_checks.check_log_folder()
    return master


def launch(watch, turn):
    """Runs roslaunch under watch; returns its exit status.

    @param turn  to start on the master; given up when all is started
    """

    class Parent(roslaunch.parent.ROSLaunchParent):
        """The parent of a launch, watched from its first process on."""

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

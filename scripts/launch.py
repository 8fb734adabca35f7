#!/usr/bin/python3
"""roslaunch that tells by its exit status whether the run went well.

Takes roslaunch's arguments and does what it does, with four differences. What can be known not to
work is refused before anything starts, in one line (run_checks.py). A node that exits with status 2
refuses its configuration (stg::RunNode): the run ends at once, where respawning would repeat it for
ever. So it does, without a word, when nobody reads its output any more. The exit status is 1 after that, when a required node, the recorder or the master died, or
when a file that was asked for was not written. And nothing is left running when a required node
dies while others start, where roslaunch gives up before its monitor has stopped them.
"""

import difflib
import os
import pathlib
import re
import signal
import sys
import xml.etree.ElementTree as ElementTree

import roslaunch
import roslaunch.parent
import roslaunch.pmon
import roslib.packages
import run_checks

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "src" / "auv_common" / "scripts"))
from stg_common.program import NOBODY_READS, Unread  # noqa: E402  (found by the line above)

REFUSED, LOST_OUTPUT = 2, 4
MONITOR_ENDS_S = 30  # a node has 15 s after SIGINT and 2 s after SIGTERM
MOST_AGENTS = 255
# Each AUV includes the launch file of the next one.
sys.setrecursionlimit(100 * MOST_AGENTS)


def node_of(process_name):
    """Returns the node of a process, which is named as it is, with a number behind."""
    return re.sub(r"-[0-9]+$", "", process_name)


class Watch(roslaunch.pmon.ProcessListener):
    """Hears of every process that dies by itself."""

    def __init__(self):
        self.required = {"master"}
        self.recorders = set()
        self.failure = ""
        self.over = False  # a node refused its configuration, or nobody reads on
        self.unread = False
        self.started = False
        self.monitor = None
        self.processes = []
        self.popens = {}  # {name: the newest}, which roslaunch forgets with the process
        self.outputs = None

    def take(self, config):
        """Notes what a launch is about to start; refuses what cannot work."""
        nodes = {(node.namespace + node.name).strip("/"): node for node in config.nodes}
        parameters = {name: parameter.value for name, parameter in config.params.items()}
        run_checks.check_numbers(parameters)
        run_checks.check_bags_are_there(config.nodes)
        if run_checks.master_is_online(config.master.uri):
            run_checks.check_names_are_free(config.master.uri, ["/" + name for name in nodes])
        self.required |= {name for name, node in nodes.items() if node.required}
        self.recorders = {name for name, node in nodes.items() if run_checks.bag_of(node)}
        self.outputs = run_checks.Outputs(config.nodes, parameters)
        self.outputs.check_before()

    def observe(self, monitor):
        """Remembers what the monitor is given to look after."""
        self.monitor = monitor
        for name in ("register", "register_core_proc"):
            setattr(monitor, name, self.remembering(getattr(monitor, name)))

    def remembering(self, register):
        """Returns the function, made to remember the processes it is given."""

        def remember(process):
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


def check_arguments(arguments):
    """Refuses what roslaunch would stumble over or hang on."""
    port = os.environ.get("ROS_MASTER_URI", "http://localhost:11311")
    for k, argument in enumerate(arguments):
        if argument.startswith("agents:="):
            number = argument[len("agents:=") :]
            if not number.isdigit() or not 1 <= int(number) <= MOST_AGENTS:
                raise run_checks.Refusal(f"agents: '{number}' is none of 1 to {MOST_AGENTS}")
        if argument.startswith("bag:=") and "'" in argument:
            raise run_checks.Refusal("bag: a name with ' in it cannot be given to the recorder")
        if argument in ("-p", "--port") and k + 1 < len(arguments):
            port = f"http://127.0.0.1:{arguments[k + 1]}"
    for name in arguments_unknown_to(arguments):
        raise run_checks.Refusal(name)
    run_checks.master_is_online(port)
    run_checks.check_log_folder()


def arguments_unknown_to(arguments):
    """Yields what is wrong with the names that a launch file is given: roslaunch would ignore them."""
    names = [a for a in arguments if ":=" not in a and not a.startswith("-")]
    if len(names) < 2:
        return
    found = roslib.packages.find_resource(names[-2], names[-1])
    if not found:
        return
    declared = [arg.get("name") for arg in ElementTree.parse(found[0]).getroot().findall("arg")
                if arg.get("value") is None]  # fmt: skip
    for name in (a.split(":=", 1)[0] for a in arguments if ":=" in a):
        if name not in declared and not name.startswith("_"):
            near = difflib.get_close_matches(name, declared, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"it has {', '.join(declared)}"
            yield f"{names[-1]} has no argument '{name}'; {hint}"


def launch(watch):
    """Runs roslaunch under watch; returns its exit status."""

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
            super().start(*arguments, **options)
            watch.started = True
            watch.end_if_over()

    roslaunch.parent.ROSLaunchParent = Parent
    try:
        roslaunch.main()
    except SystemExit as gave_up:
        return gave_up.code
    finally:
        watch.stop_the_rest()
    return 0


def main():
    """Launches; returns the exit status."""
    watch = Watch()
    status = 0
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is not None:
            setattr(sys, name, Unread(getattr(sys, name), watch.output_unread))
    try:
        check_arguments(sys.argv[1:])
        status = launch(watch)
        watch.judge()
    except run_checks.Refusal as refusal:
        watch.failure = str(refusal)
    if watch.failure:
        print(f"stg: the run failed: {watch.failure}", file=sys.stderr)
        return 1
    return NOBODY_READS if watch.unread else status


if __name__ == "__main__":
    sys.exit(main())

"""Rules of this repository that no other program checks: allowed includes, sizes and names.

Each rule takes the folder of the packages and returns (what was checked, list of findings).
"""

import collections
import re

from files import ROOT
from tree import cpp_files, included, includes, logical, read

SOURCE = ROOT / "src"
LONGEST_FILE = 350  # lines
FULLEST_FOLDER = 12  # sources and headers
REASON = re.compile(r"(//|#) Long because: \w")
HEAD = 5  # the reason must be in these first lines

# Other packages that a package may include.
MAY_INCLUDE = {
    "auv_common": set(),
    "auv_dynamics": {"auv_common"},
    "acoustic_channel": {"auv_common"},
    "stg_agent": {"auv_common", "auv_dynamics", "acoustic_channel"},
    "stg_env": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent"},
    "marl_trainer": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent", "stg_env"},
    "stg_python": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent", "stg_env"},
    "stg_monitor": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent", "stg_env"},
    "stg_bringup": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent", "stg_env"},
}
# The namespaces of a package's core, and of all nodes. They may contain other namespaces.
CORE_NAMESPACES = {
    "auv_common": ("stg",),
    "auv_dynamics": ("stg::dynamics",),
    "acoustic_channel": ("stg::acoustics",),
    "stg_agent": ("stg::agent",),
    "stg_env": ("stg::task", "stg::env"),
    "marl_trainer": ("stg::learn",),
    "stg_python": ("stg::python",),
}
# The code that composes the sections of all packages may use the namespaces of all.
SHARED_NAMESPACES = {("stg_env", "scenario"): ("stg",)}
# Parts that build things from a whole scenario, named as by `logical`. All other code takes only the sections
# that it needs. docs/architecture.md describes each of them.
COMPOSITION_ROOTS = (
    "auv_dynamics/world/world",
    "stg_agent/agent_config",
    "stg_env/scenario/",
    "stg_env/env/environment",
    "stg_env/env/trace",
    "stg_env/env/variants",
    "stg_env/env/vector_env",
    "marl_trainer/learn/recorded/recorded_trainer",
    "marl_trainer/learn/run/trainer",
    "marl_trainer/learn/swarm/recorded_swarm_trainer",
    "marl_trainer/nodes/learners/",
    "marl_trainer/tools/",
    "stg_python/bindings/",
    "stg_python/env/env_pool",
)
NODE_NAMESPACES = ("stg::nodes", "stg::topics", "stg::frames")
# Headers that a core must not include.
ROS = re.compile(
    r"(ros|rosbag|rosgraph_msgs|diagnostic_updater|tf2|tf2_\w+|std_srvs|\w+_msgs)/|.*/nodes/"
)


def part_of(file):
    """Returns "core", "nodes", "test" or "bench": the part of its package that a file belongs to. `file` is a
    path from the folder of the packages."""
    parts = file.parts
    if parts[1] in ("test", "bench"):
        return parts[1]
    return "nodes" if "nodes" in logical(file).parts[1:-1] else "core"


def check_includes(source=SOURCE):
    """Finds includes against the order of the packages, and includes of ROS or messages in a core."""
    findings = []
    for include in includes(source):
        package, other = include.file.parts[0], include.header.split("/")[0]
        reason = None
        if part_of(include.file) == "core" and ROS.match(include.header):
            reason = "the core must not include ROS headers or messages"
        elif other in MAY_INCLUDE and other not in {package} | MAY_INCLUDE.get(package, set()):
            reason = f"{package} must not depend on {other}"
        if reason:
            findings.append(f"src/{include.file}:{include.line}: {include.header}: {reason}")
    return f"{len(cpp_files(source))} files", findings


def _circles(graph):
    """Returns one path [a, b, ..., a] for each circle that a walk through {node: nodes} finds."""
    found, state, path = [], {}, []

    def visit(node):
        state[node] = "open"
        path.append(node)
        for other in sorted(graph.get(node, ())):
            if state.get(other) == "open":
                found.append([*path[path.index(other) :], other])
            elif other not in state:
                visit(other)
        path.pop()
        state[node] = "done"

    for node in sorted(graph):
        if node not in state:
            visit(node)
    return found


def check_circles(source=SOURCE):
    """Finds folders with the same parent that include each other in circles.

    Files directly in the parent are excluded, because they connect its folders.
    """
    graphs = collections.defaultdict(lambda: collections.defaultdict(set))
    where = {}
    for include in includes(source):
        if part_of(include.file) in ("test", "bench"):
            continue
        ours, theirs = logical(include.file).parts, included(include, source).parts
        depth = 0
        while depth < min(len(ours), len(theirs)) and ours[depth] == theirs[depth]:
            depth += 1
        # The first parts that differ must be folders in both paths.
        if 0 < depth < min(len(ours), len(theirs)) - 1:
            graphs[ours[:depth]][ours[depth]].add(theirs[depth])
            place = f"src/{include.file}:{include.line}"
            where.setdefault((ours[:depth], ours[depth], theirs[depth]), place)
    findings = []
    for parent, graph in sorted(graphs.items()):
        for circle in _circles(graph):
            places = ", ".join(where[parent, a, b] for a, b in zip(circle, circle[1:]))
            findings.append(f"{'/'.join(parent)}: {' -> '.join(circle)}: {places}")
    return f"{sum(map(len, graphs.values()))} folders", findings


def check_sizes(source=SOURCE):
    """Finds files that are too long without a reason, and folders with too many files."""
    findings = []
    folders = collections.Counter(path.parent for path in cpp_files(source))
    scripts = [p.relative_to(source) for p in source.rglob("*.py")]
    files = sorted([*cpp_files(source), *scripts])
    for path in files:
        lines = read(source / path).splitlines()
        if len(lines) > LONGEST_FILE and not REASON.search("\n".join(lines[:HEAD])):
            findings.append(f"src/{path}: {len(lines)} lines, and no 'Long because: ...' in its head")
    for folder, count in sorted(folders.items()):
        if count > FULLEST_FOLDER:
            findings.append(f"src/{folder}: {count} sources and headers, more than {FULLEST_FOLDER}")
    return f"{len(files)} files in {len(folders)} folders", findings


def _code(text):
    """Returns C++ text without its comments, line by line. Strings stay."""
    pattern = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
    keep = lambda m: m.group(0) if m.group(0)[0] == '"' else "\n" * m.group(0).count("\n")
    return pattern.sub(keep, text).splitlines()


def _product(source):
    """Yields (path, lines of code) for all files except tests and benchmarks."""
    for path in cpp_files(source):
        if part_of(path) not in ("test", "bench"):
            yield path, _code(read(source / path))


CONNECT = re.compile(
    r"\b(?:advertise|subscribe|advertiseService|serviceClient)\s*(?:<[^;(]*>)?\s*\(\s*\""
)
CONSTANT = re.compile(r'constexpr char k\w+\[\] = "([^"]+)"')


def check_topics(source=SOURCE):
    """Finds names of topics and services outside of headers called topics.hpp."""
    product = list(_product(source))
    named = set()
    for path, lines in product:
        if path.name == "topics.hpp":
            named |= {name for line in lines for name in CONSTANT.findall(line)}
    absolute = {name for name in named if name.startswith("/")}
    findings = []
    for path, lines in product:
        if path.name == "topics.hpp":
            continue
        for number, line in enumerate(lines, start=1):
            # The name may be on the line after the call.
            call = CONNECT.search(line + (lines[number].strip() if number < len(lines) else ""))
            if call and call.start() < len(line):
                findings.append(f"src/{path}:{number}: {call.group(0)}...: a name is not in topics.hpp")
            for name in absolute & set(re.findall(r'"([^"]*)"', line)):
                findings.append(f'src/{path}:{number}: "{name}": topics.hpp has a name for it')
    return f"{len(named)} names", findings


FORWARD = re.compile(r"namespace \w[\w:]* \{(\s*(class|struct) \w+;)+\s*\}")


def _outer_namespaces(lines):
    """Yields (line number, name) of each namespace that is not in another one and contains more than forward
    declarations."""
    depth = 0
    for number, line in enumerate(lines, start=1):
        match = re.match(r"namespace (\w[\w:]*) \{", line)
        if match and depth == 0 and not FORWARD.match("\n".join(lines[number - 1 :])):
            yield number, match.group(1)
        braces = re.sub(r'"[^"]*"|\'.\'', "", line)
        depth += braces.count("{") - braces.count("}")


def check_namespaces(source=SOURCE):
    """Finds code outside of the namespaces of its package."""
    findings = []
    looked_at = 0
    for path, lines in _product(source):
        ours = NODE_NAMESPACES
        if part_of(path) == "core":
            ours = CORE_NAMESPACES.get(path.parts[0], ())
        ours = SHARED_NAMESPACES.get(logical(path).parts[:2], ours)
        looked_at += 1
        for number, name in _outer_namespaces(lines):
            if not any(name == own or name.startswith(own + "::") for own in ours):
                findings.append(f"src/{path}:{number}: namespace {name}: not one of {', '.join(ours)}")
    return f"{looked_at} files", findings


ENTRY_FUNCTION = re.compile(r'Registry::Entry (\w+)\(\) \{\s*return \{"(\w+)"')
LISTED = re.compile(r"STG_ENTRY\(\w+, (\w+)\)")
ENTRY = re.compile(r'\{\s*"(\w+)",\s*(?:&?[A-Z]\w*|\[|std::)')
LIST = re.compile(r"static \w*Registry\w*(?:<[^;{]*>)?\s+\w+(?=[({])")


def _brackets(text, begin):
    """Returns the text from the bracket at `begin` to the one that closes it."""
    depth = 0
    for end in range(begin, len(text)):
        depth += (text[end] in "({[") - (text[end] in ")}]")
        if depth == 0:
            return text[begin:end]
    return text[begin:]


def registered(source=SOURCE):
    """Returns {name: file of the registry that lists it}."""
    names = {}
    texts = {path: "\n".join(lines) for path, lines in _product(source)}
    defined = {f: name for text in texts.values() for f, name in ENTRY_FUNCTION.findall(text)}
    for path, text in texts.items():
        for start in LIST.finditer(text):
            body = _brackets(text, start.end())
            names.update({name: path for name in ENTRY.findall(body)})
            names.update({defined[f]: path for f in LISTED.findall(body) if f in defined})
    return names


def check_registries(source=SOURCE):
    """Finds comparisons with a name that a registry lists. Only the registry may decide what a name stands
    for."""
    names = registered(source)
    compared = re.compile(r'[!=]=\s*"(\w+)"|"(\w+)"\s*[!=]=')
    findings = []
    for path, lines in _product(source):
        for number, line in enumerate(lines, start=1):
            for match in compared.finditer(line):
                name = match.group(1) or match.group(2)
                if name in names and path != names[name]:
                    findings.append(f'src/{path}:{number}: compares with "{name}", but only {names[name]} may use this name')
    return f"{len(names)} names", findings


WHOLE = re.compile(
    r"[(,]\s*(?:const\s+)?(?:std::vector<)?(?:stg::)?(?:\w+::)?(?:World|Agent)?Scenario>?\s*[&*]?\s*\w*\s*(?==|[,)])"
)


def check_scenarios(source=SOURCE):
    """Finds parameters that are a whole scenario, also of the world or of agents, or several, outside of the
    composition roots."""
    findings, looked_at = [], 0
    for path, lines in _product(source):
        looked_at += 1
        if str(logical(path)).startswith(COMPOSITION_ROOTS):
            continue
        text = "\n".join(lines)
        for match in WHOLE.finditer(text):
            number = text.count("\n", 0, match.start()) + 1
            findings.append(f"src/{path}:{number}: the function takes a whole Scenario; it must take only the sections that it needs")
    return f"{looked_at} files", findings


ALONE = re.compile(r"\branks?\w*(?:\(\))?(?:\.|->)size\(\)\s*(?:[=!]=|[<>]=?)\s*[12]\b|\b(?:Is)?Alone\(\)\s*[?!=&|]")


def check_ranks(source=SOURCE):
    """Finds checks if a process trains alone. Such a process must be treated as the only rank."""
    findings, looked_at = [], 0
    for path, lines in _product(source):
        looked_at += 1
        for number, line in enumerate(lines, start=1):
            if ALONE.search(line):
                findings.append(f"src/{path}:{number}: treats a single process in its own way; treat it as the only rank: {line.strip()}")
    return f"{looked_at} files", findings

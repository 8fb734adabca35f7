"""Strict YAML: yaml.safe_load, but things that it accepts silently or fails at are refused."""

import yaml

from stg_common.files import Damaged, is_text, read_text

# The same limits as in the loader of scenarios, auv_common/src/config/yaml_tree.cpp.
LARGEST, DEEPEST = 1 << 20, 16  # bytes, levels
MOST_VALUES = 1_000_000  # including values that aliases repeat
LARGEST_NUMBER = 1 << 64
MERGE = "tag:yaml.org,2002:merge"


def _refuse(node, what):
    raise yaml.constructor.ConstructorError(None, None, what, node.start_mark)


class _StrictLoader(yaml.SafeLoader):
    """Refuses duplicate keys, and content that would need too much time or memory."""

    def __init__(self, text):
        super().__init__(text)
        self._depth = 0
        self._values = {}  # {node: number of values in it}

    def compose_node(self, parent, index):
        self._depth += 1
        event = self.peek_event()
        if self._depth > DEEPEST:
            raise yaml.composer.ComposerError(None, None, "nested too deeply", event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(event, yaml.AliasEvent) and node not in self._values:
            raise yaml.composer.ComposerError(None, None, "an alias that contains itself", event.start_mark)
        return node

    def compose_scalar_node(self, anchor):
        return self._count(super().compose_scalar_node(anchor), ())

    def compose_sequence_node(self, anchor):
        node = super().compose_sequence_node(anchor)
        return self._count(node, node.value)

    def compose_mapping_node(self, anchor):
        node = super().compose_mapping_node(anchor)
        lines = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                name = MERGE if key.tag == MERGE else self.construct_object(key)
                line = key.start_mark.line + 1
                if name in lines:
                    _refuse(key, f"{key.value}: duplicate key, first given in line {lines[name]}")
                lines[name] = line
        return self._count(node, [part for pair in node.value for part in pair])

    def _count(self, node, parts):
        self._values[node] = 1 + sum(self._values[part] for part in parts)
        if self._values[node] > MOST_VALUES:
            _refuse(node, f"more than {MOST_VALUES} values")
        return node

    def construct_object(self, node, deep=False):
        try:
            value = super().construct_object(node, deep)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            # Errors of the constructors of dates, numbers and tags.
            _refuse(node, "this value cannot be read")
        if isinstance(value, int) and abs(value) > LARGEST_NUMBER:
            _refuse(node, "the number is too large")
        if isinstance(value, str) and not is_text(value):
            _refuse(node, "characters that are not text")
        return value


def parse_yaml(text, name):
    """The value of a YAML text. Raises Damaged with the name `name` if the text is invalid."""
    try:
        return yaml.load(text, Loader=_StrictLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = error.problem or error.context
        raise Damaged(name, what, None if mark is None else mark.line + 1) from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise Damaged(name, "a character that YAML does not allow", line) from None


def read_yaml(path):
    """The value of a YAML file."""
    return parse_yaml(read_text(path, LARGEST), path)

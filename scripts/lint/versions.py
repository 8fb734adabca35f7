"""The version is in the file VERSION, and in files that other programs read directly."""

import re
import xml.etree.ElementTree as ElementTree

from files import ROOT


def _first(path, pattern):
    """Returns the first match of `pattern` in a file, or None."""
    found = re.search(pattern, path.read_text(encoding="utf-8"), re.MULTILINE)
    return found.group(1) if found else None


def stated(root):
    """Returns {file: version that it states, or None}."""
    versions = {
        path: ElementTree.parse(path).getroot().findtext("version")
        for path in sorted(root.glob("src/*/package.xml"))
    }
    versions[root / "CITATION.cff"] = _first(root / "CITATION.cff", r"^version: (\S+)$")
    versions[root / "CHANGELOG.md"] = _first(root / "CHANGELOG.md", r"^## \[(\d\S*)\]")
    debian = root / "debian" / "changelog"
    if debian.exists():
        versions[debian] = _first(debian, r"^\S+ \(([^-)]+)")
    return versions


def check_versions(root=ROOT):
    """Compares every file that states the version with VERSION."""
    wanted = (root / "VERSION").read_text(encoding="utf-8").strip()
    findings = []
    if not re.fullmatch(r"\d+\.\d+\.\d+", wanted):
        findings.append(f"VERSION: '{wanted}' is not of the form 1.2.3")
    versions = stated(root)
    for path, version in versions.items():
        if version != wanted:
            findings.append(f"{path.relative_to(root)}: states {version}, VERSION {wanted}")
    header = root / "src/auv_common/include/auv_common/version.hpp"
    minor = _first(header, r'kMinorVersion\[\] = "([^"]+)"') if header.exists() else None
    if header.exists() and minor != wanted.rpartition(".")[0]:
        findings.append(f"{header.relative_to(root)}: states {minor}, VERSION {wanted}")
    return f"{len(versions)} files", findings

"""The place of each page of the site: the tabs at its top, and the pages below each of them."""

import json

# tab: pages and folders of docs/ in order; in a folder, README.md comes first. Pages that are not listed here
# come last, in the tab More.
TABS = {
    "Start": ["install.md", "tutorials", "gallery.md", "view.md", "platforms.md", "security.md"],
    "Fly": ["scenarios.md", "field.md", "waters.md", "recording.md", "soak.md", "faults.md", "fly_your_own_vehicle.md"],
    "Network": ["acoustic_network.md", "acoustic_channel.md", "physical_channel.md", "simulate.md", "modems.md",
                "use_with_your_own_vehicles.md"],
    "Models": ["dynamics.md", "environment.md", "sensors.md", "navigation.md", "localization.md", "estimation.md",
               "terrain.md", "equations.md", "units.md"],
    "Learn": ["python.md", "algorithms", "entities.md", "several_machines.md"],
    "Results": ["results"],
    "Extend": ["architecture.md", "how_to", "packages", "adr", "fuzzing.md"],
    "Reference": ["reference", "stability.md"],
}  # fmt: skip


def listed(pages, folder):
    """Entries of a folder: its own pages first, then its folders as sections."""
    files = sorted(folder.glob("*.md"), key=lambda one: (one.name != "README.md", one.name))
    entries = [str(one.relative_to(pages)) for one in files]
    for one in sorted(folder.iterdir()):
        if one.is_dir() and (inner := listed(pages, one)):
            entries.append({one.name.replace("_", " ").capitalize(): inner} if len(inner) > 1 else inner[0])
    return entries


def navigation(pages):
    """The entry `nav` of mkdocs for a folder of pages, as JSON, which is YAML, too."""
    nav, known = [{"STG Swarm": "index.md"}], {"index.md"}
    for tab, names in TABS.items():
        entries = []
        for name in names:
            if name.endswith(".md"):
                entries.append(name)
            elif len(names) == 1 or name == tab.lower():
                entries += listed(pages, pages / name)
            else:
                entries.append({name.replace("_", " ").capitalize(): listed(pages, pages / name)})
        known.update(names)
        nav.append({tab: entries})
    rest = [one.name for one in sorted(pages.iterdir()) if one.name not in known and (one.suffix == ".md" or any(one.rglob("*.md")))]
    if rest:
        nav.append({"More": [one for name in rest for one in ([name] if name.endswith(".md") else listed(pages, pages / name))]})
    return json.dumps(nav)

"""Colours, sizes and files of the figures. Importing this module selects a backend without display."""

import io
import os

import matplotlib.cbook
import matplotlib.pyplot as plt
from matplotlib.mathtext import MathTextParser
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from stg_study.files import write_atomically
from stg_study.study import StudyError

plt.switch_backend("Agg")  # for output to files

# Okabe and Ito's colours, which people with colour blindness can distinguish.
OTHER_COLOURS = ["#0072B2", "#009E73", "#E69F00", "#D55E00", "#CC79A7", "#56B4E9"]
OTHER_GREYS = ["#222222", "#777777", "#999999", "#bbbbbb"]
# The methods and controllers of the shipped studies have the same colours in all studies.
KNOWN = {
    "stg": "#0072B2",
    "semantic": "#009E73",
    "velocity3": "#E69F00",
    "tau6": "#D55E00",
    "curriculum": "#882255",
    "separated": "#CC79A7",
    "silent": "#56B4E9",
    "no_links_roles": "#332288",
    # Algorithms: the paper's baselines, and the study on equal terms, in which mappo is the same as stg.
    "mappo": "#0072B2",
    "ippo": "#332288",
    "happo": "#44AA99",
    "maddpg": "#C8A400",
    "matd3": "#56B4E9",
    "masac": "#CC79A7",
    "madqn": "#8C510A",
    "pursuit_separated": "#222222",
    "pursuit": "#777777",
    "pursuit_simple": "#999999",
    "idle": "#bbbbbb",
}
PAPER_COLOUR = "#dddddd"
UNIT = "Distances in workspace units (labelled km in the paper)"

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.titlesize": 10,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#e6e6e6",
        "legend.frameon": False,
    }
)


def colours(study):
    """Colour of every method and controller by name. It is the same in every study."""
    table = {}
    for entries, others in ((study.methods, OTHER_COLOURS), (study.controllers, OTHER_GREYS)):
        free = [c for c in others if c not in [KNOWN.get(e.name) for e in entries]] or others
        unknown = [e.name for e in entries if e.name not in KNOWN]
        table.update({e.name: KNOWN[e.name] for e in entries if e.name in KNOWN})
        table.update({name: free[i % len(free)] for i, name in enumerate(unknown)})
    return table


def check_labels(study, name):
    """Refuses labels with formulas that cannot be drawn. `name` is the name of the study's file."""
    for key, entries in (("methods", study.methods), ("controllers", study.controllers)):
        for entry in entries:
            try:
                if matplotlib.cbook.is_math_text(entry.label):
                    MathTextParser("path").parse(entry.label)
            except ValueError:
                where = f"{name}: {key}.{entry.name}.label"
                raise StudyError(f"{where}: '{entry.label}' holds no formula between its $") from None


def logarithmic(axis, low, high):
    """A logarithmic y axis from below `low` to above `high`, with at least three plain numbers."""
    low, high = low / 1.25, high * 1.25
    axis.set_yscale("log")
    axis.set_ylim(low, high)
    subs = (1.0, 2.0, 5.0)
    if high < 8.0 * low:
        subs = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
    if high < 2.5 * low:
        subs = (1.0, 1.2, 1.5, 1.8, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)
    axis.yaxis.set_major_locator(LogLocator(subs=subs))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def title(figure, text):
    """The figure's title, and the unit of all its distances below."""
    figure.suptitle(f"{text}\n{UNIT}", fontsize=10)


def save(figure, folder, name):
    """Writes the figure as PNG; the same content gives the same bytes. Returns the name."""
    os.makedirs(folder, exist_ok=True)
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=150, metadata={"Software": None})
    write_atomically(os.path.join(folder, f"{name}.png"), drawn.getvalue())
    plt.close(figure)
    return name


def legend_below(figure, handles, labels, columns=4):
    """One complete legend for all panels, below them; none if it would be empty. Lays out the figure above
    it."""
    if not labels:
        figure.tight_layout()
        return
    figure.canvas.draw()
    width = figure.bbox.width
    for count in range(min(columns, len(labels)), 0, -1):
        legend = figure.legend(handles, labels, loc="lower center", ncol=count)
        box = legend.get_window_extent(figure.canvas.get_renderer())
        if box.width <= width or count == 1:
            break
        legend.remove()
    figure.tight_layout(rect=(0, box.height / figure.bbox.height + 0.01, 1, 1))

"""Colours, sizes and files of the figures; importing this selects a backend without display."""

import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the backend)
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

# Okabe and Ito's colours, which the colour-blind can tell apart.
METHOD_COLOURS = ["#0072B2", "#009E73", "#E69F00", "#D55E00", "#CC79A7", "#56B4E9"]
CONTROLLER_COLOURS = ["#222222", "#777777", "#999999", "#bbbbbb"]
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
        "svg.fonttype": "none",
        "svg.hashsalt": "stg",
    }
)


def colours(study):
    """Colour of every method and controller by its name."""
    table = {m.name: METHOD_COLOURS[i % 6] for i, m in enumerate(study.methods)}
    table.update({c.name: CONTROLLER_COLOURS[i % 4] for i, c in enumerate(study.controllers)})
    return table


def logarithmic(axis):
    """A logarithmic y axis with plain numbers at 1, 2 and 5."""
    axis.set_yscale("log")
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def title(figure, text):
    """The figure's title, with the unit of all its distances below."""
    figure.suptitle(f"{text}\n{UNIT}", fontsize=10)


def save(figure, folder, name):
    """Writes the figure as PNG and SVG, the same bytes for the same content; returns its name."""
    os.makedirs(folder, exist_ok=True)
    figure.savefig(os.path.join(folder, name + ".png"), dpi=150, metadata={"Software": None})
    figure.savefig(os.path.join(folder, name + ".svg"), metadata={"Date": None})
    plt.close(figure)
    return name


def legend_below(figure, handles, labels, columns=4):
    """One legend for all panels, under them."""
    figure.legend(handles, labels, loc="lower center", ncol=min(columns, len(labels)))

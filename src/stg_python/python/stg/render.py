"""Pictures of an episode: tracks, targets, estimates and links, from above and from the side."""

import numpy as np

__all__ = ["COLOURS", "draw", "draw_views"]

# A Snapshot is the result of env.snapshot(), in SI units and world axes (ENU: x east, y north, z up):
#   time [s], step; position, velocity [N, 3]; rpy [N, 3] [rad]; target_position, target_velocity
#   [targets, 3]; estimate [N, 3]: each AUV's estimate of its target, NaN if it has lost it;
#   tracking [N, 4]: true distance [m], error [m], confidence, lost; links [N, N]: quality of the
#   link from AUV j to AUV i, in [0, 1].

COLOURS = ("#2a6fb0", "#b3641c", "#1b7f79", "#7a4fa3", "#b03a5b", "#4d6680", "#8a8a1c", "#333333")
_VIEWS = ((0, 1, "from above", "x, east [m]", "y, north [m]"),
          (0, 2, "from the side", "x, east [m]", "z, up [m]"))  # fmt: skip
_LEGEND_COLUMNS = 7  # fits into the narrowest picture of a user
_FLAT = 0.3  # a flatter side view has its own scale of heights


def _colour(i):
    return COLOURS[i % len(COLOURS)]


def _draw_view(axes, history, scenario, view):
    """Draws one projection of the history into matplotlib axes."""
    a, b, title, x_label, y_label = view
    now = history[-1]
    tracks = np.stack([shot["position"] for shot in history])  # [T, N, 3]
    targets = np.stack([shot["target_position"] for shot in history])
    position, links = now["position"], now["links"]
    for i in range(len(position)):
        for j in range(i):
            quality = max(links[i, j], links[j, i])
            if quality > 0.0:
                axes.plot(*position[[i, j]][:, (a, b)].T, color="#999999", lw=1.0, alpha=quality,
                          zorder=1)  # fmt: skip
    for k in range(targets.shape[1]):
        axes.plot(*targets[:, k, (a, b)].T, color="#d02060", lw=1.0, zorder=2)
        axes.plot(*targets[-1, k, (a, b)], "*", color="#d02060", ms=13, zorder=5,
                  label=None if k else "target")  # fmt: skip
    for i in range(len(position)):
        axes.plot(*tracks[:, i, (a, b)].T, color=_colour(i), lw=1.2, zorder=3)
        axes.plot(*position[i, (a, b)], "o", color=_colour(i), ms=7, zorder=6, label=f"auv_{i}")
        axes.plot(*now["estimate"][i, (a, b)], "x", color=_colour(i), ms=8, mew=1.6, zorder=7)
    axes.plot([], [], "x", color="#333333", ms=8, mew=1.6, label="estimates of it")
    # The smallest range that shows everything, but not larger than the water.
    shown = np.concatenate([tracks.reshape(-1, 3), targets.reshape(-1, 3)])[:, (a, b)]
    extent = scenario["workspace.half_extent_m"]
    half = min(max(0.55 * np.ptp(shown, axis=0).max(), 0.05 * extent), 1.02 * extent)
    middle = 0.5 * (shown.max(axis=0) + shown.min(axis=0))
    halves = [half, half]
    upright = 0.55 * float(np.ptp(shown[:, 1]))
    if b == 2 and 0.0 < upright < _FLAT * half:
        halves[1] = max(1.2 * upright, 0.02 * half)
        title += f" (heights {half / halves[1]:.0f} times)"
    for set_limits, centre, reach in zip((axes.set_xlim, axes.set_ylim), middle, halves):
        set_limits(centre - reach, centre + reach)
    for wall in (-extent, extent):
        axes.axhline(wall, color="#333333", lw=2.0)
        axes.axvline(wall, color="#333333", lw=2.0)
    axes.set(title=title, xlabel=x_label, ylabel=y_label, box_aspect=1.0)
    axes.grid(True, color="#e4e4e4", lw=0.6)


def draw_views(figure, history, scenario):
    """Draws both views into a matplotlib Figure.

    history: Snapshots from the first to the present; scenario: the Scenario that they are of.
    """
    top, side = figure.subplots(1, 2)
    for axes, view in zip((top, side), _VIEWS):
        _draw_view(axes, history, scenario, view)
    now = history[-1]
    lost = int(np.sum(now["tracking"][:, 3] > 0.5))
    figure.suptitle(
        f"{scenario.name}: {now['time']:.1f} s, mean distance to the target "
        f"{now['tracking'][:, 0].mean():.3f} m" + (f", {lost} lost" if lost else "")
    )
    rows = 0
    if len(now["position"]) <= len(COLOURS):
        handles, labels = top.get_legend_handles_labels()
        rows = -(-len(labels) // _LEGEND_COLUMNS)
        figure.legend(handles, labels, loc="lower center", ncol=-(-len(labels) // rows),
                      frameon=False)  # fmt: skip
    figure.subplots_adjust(left=0.08, right=0.98, top=0.86, bottom=0.15 + 0.04 * rows, wspace=0.28)


def draw(history, scenario, width=1000, height=540):
    """Returns a picture [height, width, 3] uint8 of an episode: see draw_views."""
    # pylint: disable=import-outside-toplevel
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    dpi = 100
    figure = Figure(figsize=(width / dpi, height / dpi), dpi=dpi)
    canvas = FigureCanvasAgg(figure)
    draw_views(figure, history, scenario)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()

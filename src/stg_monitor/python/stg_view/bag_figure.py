"""The figure of one recorded episode; used by bag_report.py."""

from collections import defaultdict

import matplotlib.pyplot as plt

plt.switch_backend("Agg")  # for output to files

PHASE_COLOURS = {
    "search": "#4a8cff",
    "approach": "#f5a11a",
    "stable": "#2fb457",
    "lost": "#e23636",
}
MAX_POINTS = 4000


def thin(rows):
    """Returns at most MAX_POINTS of `rows`, evenly spread and always with the last one."""
    stride = max(1, -(-len(rows) // MAX_POINTS))
    return rows[::stride] + (rows[-1:] if rows and (len(rows) - 1) % stride else [])


def grouped(run, table, episode, key):
    """Returns {value of `key`: rows} of one episode."""
    rows = run.of_episode(table, episode)
    groups = defaultdict(list)
    for value, row in zip(run.column(table, key, rows), rows):
        groups[value].append(row)
    return dict(sorted(groups.items()))


def draw_trajectories(axes, run, episode, across, up):
    """Draws the paths of AUVs (coloured by number) and targets in one plane."""
    for auv, rows in grouped(run, "poses", episode, "auv").items():
        rows = thin(rows)
        x, y = run.column("poses", across, rows), run.column("poses", up, rows)
        (line,) = axes.plot(x, y, linewidth=1.0, label=f"AUV {auv}")
        axes.plot(x[:1], y[:1], "o", color=line.get_color(), markersize=4)
    for target, rows in grouped(run, "targets", episode, "target").items():
        rows = thin(rows)
        x, y = run.column("targets", across, rows), run.column("targets", up, rows)
        axes.plot(x, y, color="black", linewidth=1.6, linestyle="--", label=f"target {target}")
        axes.plot(x[-1:], y[-1:], "*", color="black", markersize=8)
    axes.set_xlabel(f"{across} [m], world")
    axes.set_ylabel(f"{up} [m], world")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(alpha=0.3)


def draw_distances(axes, run, episode, start):
    """Draws the true distance of each AUV to its target and the tracking band."""
    for auv, rows in grouped(run, "poses", episode, "auv").items():
        rows = thin(rows)
        times = [t - start for t in run.column("poses", "t", rows)]
        axes.plot(times, run.column("poses", "distance", rows), linewidth=1.0, label=f"AUV {auv}")
    band = (run.scenario.get("reward") or {}).get("band_m")
    if band:
        axes.axhspan(band[0], band[1], color="#2fb457", alpha=0.25, label="tracking band")
    axes.set_yscale("log")
    axes.set_ylabel("distance to target [m]")
    axes.legend(fontsize=7, ncol=2)
    axes.grid(alpha=0.3, which="both")


def draw_phases(axes, run, episode, start):
    """Draws one strip per AUV: the phase as colour, and a black line above it while the AUV leads."""
    groups = grouped(run, "tasks", episode, "auv")
    for auv, rows in groups.items():
        times = [t - start for t in run.column("tasks", "t", rows)]
        phases = run.column("tasks", "phase", rows)
        leads = run.column("tasks", "role", rows)
        ends = times[1:] + [2 * times[-1] - times[-2] if len(times) > 1 else times[-1]]
        for phase, colour in PHASE_COLOURS.items():
            axes.broken_barh(runs(times, ends, [p == phase for p in phases]), (auv - 0.35, 0.6),
                             color=colour, linewidth=0)  # fmt: skip
        axes.broken_barh(runs(times, ends, leads), (auv + 0.27, 0.1), color="black", linewidth=0)
    axes.set_yticks(list(groups))
    axes.set_yticklabels([f"AUV {auv}" for auv in groups])
    handles = [plt.Rectangle((0, 0), 1, 1, color=c) for c in PHASE_COLOURS.values()]
    handles.append(plt.Rectangle((0, 0), 1, 1, color="black"))
    axes.legend(handles, [*PHASE_COLOURS, "leads"], fontsize=7, ncol=5, loc="upper center",
                bbox_to_anchor=(0.5, 1.14), frameon=False)  # fmt: skip
    axes.set_ylabel("phase")


def runs(times, ends, flags):
    """Returns [(start, length)] of each stretch in which `flags` is true."""
    found = []
    for begin, end, flag in zip(times, ends, flags):
        if not flag:
            continue
        if found and abs(sum(found[-1]) - begin) < 1e-9:
            found[-1] = (found[-1][0], end - found[-1][0])
        else:
            found.append((begin, end - begin))
    return found


def draw_links(axes, run, episode, start, value, label):
    """Draws mean, smallest and largest of one number over all links."""
    groups = grouped(run, "links", episode, "t")
    times = thin(list(groups))
    values = [run.column("links", value, groups[t]) for t in times]
    shown = [t - start for t in times]
    axes.fill_between(shown, [min(v) for v in values], [max(v) for v in values], alpha=0.25,
                      label="smallest to largest")  # fmt: skip
    axes.plot(shown, [sum(v) / len(v) for v in values], linewidth=1.2, label="mean over links")
    axes.set_ylabel(label)
    axes.legend(fontsize=7)
    axes.grid(alpha=0.3)


def draw_episode(run, episode, path):
    """Writes `path`.png and `path`.svg."""
    times = run.column("poses", "t", run.of_episode("poses", episode))
    start, end = min(times), max(times)
    figure, axes = plt.subplots(3, 2, figsize=(12, 11), constrained_layout=True)
    draw_trajectories(axes[0][0], run, episode, "x", "y")
    draw_trajectories(axes[0][1], run, episode, "x", "z")
    axes[0][0].legend(fontsize=7)
    draw_distances(axes[1][0], run, episode, start)
    draw_phases(axes[1][1], run, episode, start)
    if run.of_episode("links", episode):
        draw_links(axes[2][0], run, episode, start, "quality", "link quality [-]")
        draw_links(axes[2][1], run, episode, start, "age", "age of information [s]")
    else:
        for empty in axes[2]:
            empty.text(0.5, 0.5, "no links recorded", ha="center", transform=empty.transAxes)
    for row in axes[1:]:
        for panel in row:
            panel.set_xlim(0.0, max(end - start, 1e-3))
            panel.set_xlabel("time in the episode [s]")
    name = run.scenario.get("name", "run")
    figure.suptitle(f"{name}, episode {episode}: {end - start:.1f} s")
    for suffix in ("png", "svg"):
        figure.savefig(f"{path}.{suffix}", dpi=110)
    plt.close(figure)
